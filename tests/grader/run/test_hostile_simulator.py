"""What is sent to the simulator, by ROS or on the link, ends a run at worst, and gains nothing."""

import os
import signal
from dataclasses import replace
from typing import Any

import pytest

import grader
from grader.errors import GraderFailure
from grader.recording.recording import Recording, Recordings
from grader.run import handover, real_time, virtual_time
from grader.run.handover import Plan
from grader.run.limits import Patience
from grader.run.simulator import hub, link
from grader.scenes.scene import Limits
from grader.scenes.turtlesim.graded_node import LONGEST_NAME, MOST_TURTLES
from tests import runs
from tests.runs import CHALLENGE, SUBMISSIONS
from tests.tiers import others_are_more
from turtlesim_py.world.events import Kill

LIMITS = Limits(first_motion_s=3, rest_s=2, total_s=5)
PATIENCE = Patience(run_cpu_s=20, simulator_cpu_s=20, asleep_s=1.0)
#: For a turtle that moves, and for pens that are not set too often.
MOST_POINTS = 20
#: More than these see to.
LONG = Limits(first_motion_s=30, rest_s=2, total_s=30)
BUSY = replace(PATIENCE, simulator_cpu_s=0.2)
#: Name -> how it may end, what a flag says of it, and what it is run with.
ENDS: dict[str, tuple[set[str], object, Limits]] = {
    "floods_the_link": ({"killed", "stalled"}, "", LIMITS),
    "goals_without_end": ({"time_limit"}, "rotation goals", replace(LIMITS, total_s=10)),
    "asks_and_never_reads": ({"killed"}, "does not read what it has asked for", LIMITS),
    "lets_no_time_pass": ({"killed"}, hub.VAIN, LIMITS),
    "sends_without_measure": ({"killed"}, link.TOO_MANY, LONG),
    "sends_gigabytes": ({"killed"}, link.TOO_MANY, LONG),
    "thousands_of_topics": ({"finished"}, "", LIMITS),
}


def run(name: str, patience: Patience = PATIENCE, limits: Limits = LIMITS) -> Recording:
    """What is recorded of one of them; it is judged, too, and earns next to nothing."""
    recording = runs.recorded(f"hostile_simulator/{name}", Plan(limits), patience)
    assert recording.run.time == "virtual"
    alone = replace(CHALLENGE, varied=replace(CHALLENGE.varied, count=0))
    assert grader.judge(Recordings(recording), alone).score <= MOST_POINTS
    return recording


def flags(recording: Recording) -> str:
    return "\n".join(map(str, recording.run.flags))


@pytest.mark.parametrize(
    "name", others_are_more("seconds each; one flood stands for them", ENDS, "floods_the_link")
)
def test_a_flood_ends_and_is_told(name):
    outcomes, flag, limits = ENDS[name]
    recording = run(name, limits=limits)
    assert recording.run.outcome in outcomes
    assert str(flag) in flags(recording)
    assert len(recording.topics) <= 1_000


def test_who_keeps_the_simulator_busy_is_told_so():
    recording = run("lets_no_time_pass", BUSY)
    assert recording.run.outcome == "killed"
    assert virtual_time.FLOODING.given(seconds="0") in recording.run.flags


def test_values_of_unknown_types_are_refused():
    recording = run("sets_what_is_no_parameter")
    assert (recording.run.outcome, recording.run.exit_code) == ("finished", 0)
    # each parameter alone, and both at once; for two types
    assert recording.output.count("Unknown type: 10'") == 3
    assert recording.output.count("Unknown type: 255'") == 3
    assert recording.run.flags == ()


@pytest.mark.more("the clock of a run cannot be set either")
def test_pictures_are_written_into_the_folder_of_the_run():
    recording = run("writes_pictures_elsewhere")
    # the folder is not set, and the picture is saved where it always is
    expected = [f"False True canvas_00{number}.png" for number in range(1, 6)]
    assert recording.output.splitlines() == [*expected, "False"]
    assert not (SUBMISSIONS / "hostile_simulator" / "elsewhere").exists()
    assert "canvas_folder cannot be set" in flags(recording)
    assert "100 pictures" in flags(recording)


def test_the_clock_of_a_run_cannot_be_stopped():
    recording = run("stops_the_clock")
    way = recording.trace.trajectory()
    # the watchdog strikes a second after the one command
    assert way.x[-1] - way.x[0] == pytest.approx(0.5, abs=0.03)
    assert "use_sim_time cannot be set" in recording.output
    assert "use_sim_time cannot be set" in flags(recording)


@pytest.mark.more("four seconds; names are cut by the same allowance")
def test_there_are_only_so_many_turtles():
    recording = run("hatches_hundreds")
    assert recording.output.splitlines()[0] == str(MOST_TURTLES - 1)
    assert "turtles" in flags(recording)
    assert "could not serve" not in flags(recording)


def test_names_are_cut():
    recording = run("names_of_megabytes")
    killed = recording.trace.of_kind(Kill)
    assert max(len(event.name) for event in killed) == LONGEST_NAME
    assert max(len(line.text) for line in recording.trace.logs) < 1_000
    assert "too long" in flags(recording)


# What kills it nevertheless -------------------------------------------------------------------


@pytest.fixture
def short():
    return replace(CHALLENGE, limits=LIMITS, varied=replace(CHALLENGE.varied, count=0))


def kill_when(monkeypatch: pytest.MonkeyPatch, has_met: bool, times: int) -> None:
    """Kill so many simulators: when they have met the submission's process, or at once."""
    watch, left = virtual_time._watch, [times]

    def watch_and_kill(started: Any, pid: int, budget: Any) -> Any:
        said = started.next

        def kill_then_hear(patience_s: float) -> Any:
            message = said(patience_s) if has_met else None
            if left[0] and (message is not None and message["say"] == "met") == has_met:
                left[0] -= 1
                os.kill(started.pid, signal.SIGKILL)
            return message if has_met else said(patience_s)

        monkeypatch.setattr(started, "next", kill_then_hear)
        return watch(started, pid, budget)

    monkeypatch.setattr(virtual_time, "_watch", watch_and_kill)


def test_a_simulator_that_is_killed_once_does_not_count(short, monkeypatch):
    undisturbed = runs.graded("styles/timer", short)
    kill_when(monkeypatch, has_met=True, times=1)
    result = grader.grade(SUBMISSIONS / "styles/timer.py", short)
    assert result.run.trace_sha256 == undisturbed.run.trace_sha256
    assert result.score == undisturbed.score


def test_a_simulator_that_dies_twice_of_a_submission_is_no_failure_of_the_grader(
    short, monkeypatch, tmp_path
):
    kill_when(monkeypatch, has_met=True, times=2)
    recordings = grader.record(SUBMISSIONS / "styles/timer.py", short)
    assert (recordings.nominal.run.outcome, recordings.nominal.run.ticks) == ("killed", 0)
    assert "in both tries" in flags(recordings.nominal)
    assert "exit code is -9" in flags(recordings.nominal)
    assert grader.judge(recordings, short).score == 0
    grader.save_recordings(recordings, tmp_path / "recording")
    again = grader.load_recordings(tmp_path / "recording")
    assert again.nominal.run == recordings.nominal.run


def test_a_simulator_that_dies_before_anybody_has_spoken_is_the_graders_failure(short, monkeypatch):
    kill_when(monkeypatch, has_met=False, times=2)
    with pytest.raises(GraderFailure, match="the simulator"):
        grader.grade(SUBMISSIONS / "styles/timer.py", short)


@pytest.mark.parametrize(
    "time", ["virtual", pytest.param("real", marks=pytest.mark.more("two runs in real time"))]
)
def test_a_recording_that_cannot_be_read_is_as_good_as_none(short, monkeypatch, time):
    short = replace(short, limits=Limits(0.2, 0.2, 5))
    still = runs.written("import rclpy\nrclpy.init()\nrclpy.create_node('still')\n")

    def fail(*_: object) -> None:
        raise GraderFailure("the simulator left no recording: nonsense")

    assert real_time.handover is handover
    monkeypatch.setattr(handover, "fetch", fail)
    result = grader.grade(still, short, time=time)
    assert (result.run.outcome, result.score) == ("killed", 0)
    assert any("left no recording" in str(flag) for flag in result.run.flags)
