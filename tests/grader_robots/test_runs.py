"""The tutorial's node in virtual time: as in real time, and the same every time."""

from dataclasses import replace

import pytest

from grader import grading, judging
from grader.exercise.loading import load_exercise
from grader.recording.recording import Recordings
from grader.testing.solutions import read_solutions
from grader_robots.scene import motion
from grader_robots.scene.trace import RobotTrace
from tests import archive, runs
from tests.grader_robots.packages import written

EXERCISE = load_exercise("state_publisher")
LOOP = EXERCISE.folder / "right" / "constructor_loop.py"
LAUNCH = "launch/walker.launch.py"
REFERENCE = read_solutions(EXERCISE)[0].path
#: For what does not depend on how long it runs.
SHORT = replace(EXERCISE, limits=replace(EXERCISE.limits, total_s=1.5))
TWO_STAMPS = "odom_trans.header.stamp = now.to_msg()"


@pytest.fixture(scope="module")
def recorded():
    return runs.recordings(LOOP, EXERCISE)


def trace_of(recordings: Recordings) -> RobotTrace:
    return RobotTrace.of(recordings.nominal.trace)


def test_a_loop_in_the_constructor_runs_in_virtual_time(recorded):
    run = recorded.nominal.run
    assert (run.time, run.outcome) == ("virtual", "finished")
    assert recorded.nominal.package is None  # a single file is in none
    trace = trace_of(recorded)
    assert len(trace.joint_states) == 600  # 30 a second for 20 s, of which half go on
    own = {t.message for t in trace.transforms if t.publisher == "scene"}
    assert len(own) == pytest.approx(300, abs=3)


def test_a_recording_is_read_back_as_it_was_and_so_is_its_package(tmp_path):
    recorded = archive.recordings("state_publisher", "right")
    judging.save_recordings(recorded, tmp_path / "recording")
    read = judging.load_recordings(tmp_path / "recording")
    assert trace_of(read).messages == trace_of(recorded).messages
    verdicts = [judging.judge(each, EXERCISE).verdicts for each in (recorded, read)]
    assert verdicts[0] == verdicts[1]
    assert read.nominal.package == recorded.nominal.package
    assert [each.name for each in read.nominal.package.setup.scripts] == ["state_publisher"]
    assert recorded.nominal.run.flags == ()


def test_what_a_launch_file_would_have_started_otherwise_is_told(tmp_path):
    text = (REFERENCE / LAUNCH).read_text().replace('output="screen"', 'parameters=[{"r": 1.0}]')
    package = written(tmp_path, {LAUNCH: text}, REFERENCE)
    (remark,) = grading.record(package, SHORT).nominal.run.flags
    assert str(remark) == (
        "launch/walker.launch.py was evaluated and not run: state_publisher was started by itself, "
        "without its parameters (r)"
    )


@pytest.mark.more("a run in real time")
def test_the_same_in_real_time():
    recorded = grading.record(LOOP, SHORT, time="real").nominal
    assert recorded.run.time == "real"
    trace = RobotTrace.of(recorded.trace)
    states, own = trace.joint_states, [t for t in trace.transforms if t.publisher == "scene"]
    assert {name for state in states for name in state.names} == {"swivel", "tilt", "periscope"}
    assert {t.child for t in own} > {"head", "body", "rod"}
    assert len(motion.odometry(trace)) == pytest.approx(len(states), abs=1)


def test_what_is_added_so_that_it_starts_here_is_not_looked_at(tmp_path):
    found = "packages=__import__('setuptools').find_packages()"
    setup = (REFERENCE / "setup.py").read_text().replace("packages=[package_name]", found)
    package = written(tmp_path, {"walker/__init__.py": None, "setup.py": setup}, REFERENCE)
    (script,) = grading.record(package, SHORT).nominal.package.setup.scripts
    assert str(script.fault) == "setup.py does not list the package walker, so nothing installs it"


def test_two_questions_for_the_time_in_one_step_get_two_answers(tmp_path):
    text = LOOP.read_text()
    assert text.count(TWO_STAMPS) == 1
    asked = text.replace(TWO_STAMPS, TWO_STAMPS.replace("now", "self.get_clock().now()"))
    (tmp_path / "node.py").write_text(asked)
    trace = trace_of(grading.record(tmp_path / "node.py", SHORT))
    told = {state.stamp_ns for state in trace.joint_states}
    apart = [t for t in trace.transforms if t.child == "axis" and t.stamp_ns not in told]
    assert len(apart) == len(trace.joint_states)
