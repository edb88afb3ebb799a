"""A submission that is looked at: one confined process, the same findings every time."""

import sys
import zipfile

import pytest

import grader
from grader import judging
from grader.errors import ExerciseError, GraderFailure, SubmissionError
from grader.exercise.loading import load_exercise
from grader.run import inspecting
from grader.run.processes import levels, network
from grader.submission.package_trace import FAILED
from grader.system import scratch
from tests import archive, runs
from tests.grader.run.test_opening import TEXTS
from tests.grader.test_packages_at_each_level import expect_same_verdict
from tests.grader_robots.packages import EXERCISE, REFERENCE, looked_at, recorded, written
from tests.tiers import others_are_more

NEVER_ENDS = "while True:\n    pass\n"


def graded(folder, code):
    """The reference whose set-up does this first."""
    text = (REFERENCE / "setup.py").read_text()
    return grader.grade(written(folder, {"setup.py": f'"""Set up."""\n{code}\n{text}'}), EXERCISE)


def shares(result):
    return {v.check: v.score / v.max_score for v in result.verdicts}


def test_what_is_found_is_the_same_without_confinement():
    once = archive.result("description_package", "right")  # each test_archive looks at it anew
    assert once.run.trace_sha256 == looked_at(REFERENCE).sha256()
    assert (once.score, once.max_score) == (100, 100)
    assert (once.run.outcome, once.run.ticks, once.run.simulated_s) == ("finished", 0, 0)


def test_it_is_confined_as_a_submission_s_process_is():
    run = runs.recordings(REFERENCE, EXERCISE).nominal.run
    with scratch.make_folder() as folder, network.obtain_isolation(folder) as isolated:
        assert run.isolation.startswith(levels.best(isolated).name())


@pytest.mark.more("tests/attacks does what matters at each level")
@pytest.mark.parametrize("level", [levels.LANDLOCK, levels.LIMITS])
def test_a_package_has_the_same_verdict_at_each_level(level):
    expect_same_verdict(level, "description_package")


def test_a_zip_is_looked_at_as_its_folder_is(tmp_path):
    path = tmp_path / "walker.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for file in REFERENCE.rglob("*"):
            if "__pycache__" not in file.parts:
                archive.write(file, file.relative_to(REFERENCE.parent))
    assert grader.grade(path, EXERCISE).score == 100


def test_of_several_packages_one_can_be_asked_for(tmp_path):
    for name in ("a_description", "b_description"):
        manifest = (REFERENCE / "package.xml").read_text()
        files = {"package.xml": manifest.replace("walker_description", name)}
        written(tmp_path / name, files)
    for name in ("a_description", "b_description"):
        assert looked_at(tmp_path, name).setup.name == name
    trace = grader.record(tmp_path, EXERCISE, executable="b_description").nominal.trace
    assert trace.setup.name == "b_description"
    with pytest.raises(SubmissionError, match="has no package c_description; there is"):
        grader.record(tmp_path, EXERCISE, executable="c_description")


def test_what_holds_no_package_is_refused(tmp_path):
    file = tmp_path / "walker.urdf"
    file.write_text("<robot name='a'/>")
    with pytest.raises(SubmissionError, match="holds no ROS 2 package"):
        grader.grade(tmp_path, EXERCISE)
    with pytest.raises(
        SubmissionError, match=r"nor a folder, nor a \.zip .* Hand in the folder of your"
    ):
        grader.grade(file, EXERCISE)


def test_a_set_up_that_writes_wherever_it_can_spoils_its_own_answer_alone(tmp_path):
    result = graded(tmp_path, TEXTS["forges"])
    # what it would install is not known, so neither is what ros2 launch would start
    lost = dict.fromkeys(("installed", "launch", "spawn"), 0.0)
    assert shares(result) == {**dict.fromkeys(EXERCISE.points, 1.0), **lost}
    assert result.run.outcome == "finished"


def test_what_a_set_up_leaves_running_is_ended_and_costs_nothing(tmp_path):
    daemons = """
import os, time
for _ in range(8):
    if os.fork() == 0:
        os.setsid()
        if os.fork() == 0:
            time.sleep(1000)
        os._exit(0)
"""
    assert graded(tmp_path, daemons).score == 100


def test_a_launch_file_that_never_ends_costs_what_it_would_have_shown(tmp_path):
    path = written(tmp_path, {"launch/spawn.launch.py": NEVER_ENDS})
    result = judging.judge(recorded(looked_at(path, cpu_s=0.3)), EXERCISE)
    assert shares(result) | {"launch": 1.0, "spawn": 0.0} == shares(result)
    assert "did not come to an end" in str(result.diagnosis.cause)


def test_a_set_up_that_deletes_the_package_is_told_what_is_missing(tmp_path):
    result = graded(tmp_path, "import shutil\nshutil.rmtree('.', ignore_errors=True)")
    assert result.run.outcome == "finished"
    assert shares(result)["installed"] == 0
    assert "there is no such file" in str(result.diagnosis.cause)


@pytest.mark.parametrize(
    ("signal", "outcome", "said"),
    [
        ("SIGKILL", "killed", "killed by the signal SIGKILL"),
        ("SIGSTOP", "time_limit", str(inspecting.STOPPED)),
    ],
)
def test_a_set_up_that_kills_or_stops_who_looks_is_judged_and_gets_nothing(
    signal, outcome, said, tmp_path, monkeypatch
):
    monkeypatch.setattr(inspecting, "EVERY_S", 0.05)
    result = graded(tmp_path, f"import os, signal\nos.kill(os.getppid(), signal.{signal})\n")
    assert (result.score, result.run.outcome) == (0, outcome)
    (flag,) = result.run.flags
    assert said in f"{flag!s} {result.diagnosis.cause!s}"


@pytest.mark.parametrize(
    ("code", "inspection_s", "said"),
    [
        (f"print('Error: a'); exit({FAILED})", 60, r"failed: Error: a\. That is no fault"),
        ("import time; time.sleep(600)", 0.1, r"took more than 0 s"),
    ],
)
def test_what_fails_or_hangs_in_the_grader_is_no_verdict(code, inspection_s, said, monkeypatch):
    monkeypatch.setattr(inspecting, "command", lambda *_: [sys.executable, "-c", code])
    monkeypatch.setattr(inspecting, "INSPECTION_S", inspection_s)
    with pytest.raises(GraderFailure, match=said):
        grader.grade(REFERENCE, EXERCISE)


def test_an_exercise_without_nodes_has_no_limits(tmp_path):
    (tmp_path / "exercise.yaml").write_text(
        "{exercise: mine, title: Mine, scene: package, limits: {total_s: 5}, points: {a: 1}}"
    )
    (tmp_path / "checks.py").write_text("from grader import Checks\n\nchecks = Checks()\n")
    with pytest.raises(ExerciseError, match="nothing is started in the scene 'package'"):
        load_exercise(tmp_path)
    assert EXERCISE.conditions == {}


@pytest.mark.parametrize(
    "what", others_are_more("a grading each", ["stubs", "empty", "prefix", ""], "prefix")
)
def test_a_set_up_that_puts_a_file_where_it_is_looked_at_is_judged(what, tmp_path):
    code = (
        "import glob, os, shutil, tempfile\n"
        "for each in glob.glob(f'{tempfile.gettempdir()}/package-*'):\n"
        f"    shutil.rmtree(each + '/{what}', ignore_errors=True)\n"
        f"    open(each.rstrip('/') + '/{what}'.rstrip('/'), 'w').close()\n"
    )
    result = graded(tmp_path, code)
    assert result.run.outcome == "finished"
    assert min(shares(result).values()) == 0


#: Fills every place that it may write to, with files of so many bytes.
FULL = """
import os
import tempfile
for folder in (tempfile.gettempdir(), os.path.expanduser("~"), "/tmp", os.getcwd()):
    try:
        for number in range(20_000):
            with open(f"{folder}/full{number}", "wb", buffering=0) as file:
                file.write(bytes(SIZE))
    except OSError:
        pass
"""


@pytest.mark.parametrize("size", others_are_more("files: as bytes", [2**20, 0], 2**20))
def test_a_set_up_that_leaves_no_room_is_judged(size, tmp_path):
    result = graded(tmp_path, FULL.replace("SIZE", str(size)))
    assert result.run.outcome == "finished"
    assert shares(result)["launch"] == 0
    assert "No space left on device" in str(result.diagnosis.cause)
