"""The checks of an added exercise judge as those of a folder do, and harm nobody."""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from unittest.mock import ANY

import pytest

from grader import judge, load_exercise
from grader.cli import main
from grader.errors import CheckFailed, ExerciseError, UsageError
from grader.exercise import asking, confined
from grader.judging import judge_nominal, save_recordings
from grader.recording.recording import Recordings
from grader.run.sandbox import landlock
from grader.testing import drive, twist
from grader.testing.checking import examine, odd_recordings
from tests.grader.added.repositories import added, commit
from tests.grader.testing import exercises
from tests.tiers import others_are_more

ROOT = Path(__file__).parents[3]
REFUSING = str(ROOT / "tests" / "refusing.py")
EXERCISES = Path(confined.__file__).parents[1] / "exercises"


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))


def ahead(tick, pose, arena):
    if tick == 1:
        twist(arena, 1.0, 0.0)


@pytest.fixture(scope="module")
def recordings():
    return Recordings(drive(ahead, 100))


def taken(tmp_path, name, *, like):
    """Add a copy of one of our exercises under another name."""
    repository = tmp_path / "repository"
    for path in (EXERCISES / like).rglob("*"):
        if path.is_file() and path.suffix != ".pyc":
            copy = repository / path.relative_to(EXERCISES / like)
            copy.parent.mkdir(parents=True, exist_ok=True)
            text = path.read_text().replace(f"exercise: {like}\n", f"exercise: {name}\n")
            copy.write_text(text)
    commit(repository)
    return added(repository, name)


@pytest.fixture(scope="module")
def squares(tmp_path_factory):
    """The exercise square, and an added copy of it."""
    tmp_path = tmp_path_factory.mktemp("square")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_DATA_HOME", str(tmp_path))
        taken(tmp_path, "my_square", like="square")
        return load_exercise("square"), load_exercise("my_square")


def test_one_of_ours_judges_as_it_does_at_home_and_its_results_name_its_origin(squares):
    ours, theirs = squares
    assert [replace(check, function=None) for check in ours.checks] == [
        replace(check, function=None) for check in theirs.checks
    ]
    wall = odd_recordings(ours)["a node that drives into a wall"]
    here, there = (judge(wall, each) for each in squares)
    assert here.score
    assert replace(there, exercise="square") == here
    found = there.to_json()["provenance"]["judged"]["exercise_from"]
    assert found["sha256"] == theirs.origin.sha256
    assert found["address"].startswith("file:///")
    assert type(there).from_json(there.to_json()) == there
    assert load_exercise(theirs.folder) == replace(theirs, checks=ANY)  # by its path, too


def test_where_the_varied_runs_go_on_the_nominal_one_is_judged_alone(squares):
    nominal = odd_recordings(squares[0])["a node that drives into a wall"].nominal
    here, there = (judge_nominal(nominal, each).verdicts for each in squares)
    assert here == there
    assert 0 < len(here) < len(squares[0].points)


def test_an_exercise_that_is_data_alone_and_its_edited_copy_are_judged_there(tmp_path):
    taken(tmp_path, "my_talker", like="talker")
    edited = tmp_path / "edited.yaml"
    edited.write_text("exercise: my_talker\npoints: {node: 3}\n")
    ours, theirs = load_exercise("talker"), load_exercise(edited)
    odd = odd_recordings(ours)["nothing at all"]
    verdict = next(each for each in judge(odd, ours).verdicts if each.check == "node")
    assert judge(odd, theirs).verdicts == (replace(verdict, max_score=3.0),)


def test_a_changed_file_is_refused(squares, recordings):
    exercise = squares[1]
    before = (exercise.folder / "checks.py").read_bytes()
    (exercise.folder / "checks.py").write_bytes(before + b"# changed\n")
    try:
        with pytest.raises(ExerciseError, match="no longer what was added"):
            load_exercise(exercise.folder)
        with pytest.raises(ExerciseError, match="no longer what was added"):
            judge(recordings, exercise)
    finally:
        (exercise.folder / "checks.py").write_bytes(before)


# A stranger's ----------------------------------------------------------------------------------

BEGIN = """
import glob, json, os, signal, socket, sys, time
from pathlib import Path
from grader import Checks, Finding
checks = Checks()
"""
CHECK = """
@checks()
def hostile(recordings, tolerances):
    '''A title.'''
"""


def strange(tmp_path, body, before="", **tolerances):
    """Add an exercise whose only check does this; load it."""
    add_strange(tmp_path, body, before, **tolerances)
    return load_exercise("hostile")


def add_strange(tmp_path, body, before="", **tolerances):
    code = BEGIN + before + CHECK + "".join(f"    {line}\n" for line in body.splitlines())
    folder = tmp_path / "hostile"
    exercises.write(folder, code, exercise="hostile", points={"hostile": 1}, tolerances=tolerances)
    commit(folder)
    added(folder, "hostile")


REACHES = """
got = []
def attempt(name, work):
    try:
        work()
    except (OSError, ValueError) as error:
        return
    got.append(name)
for path in tolerances["paths"]:
    attempt(f"reads {path}", lambda: open(path).read())
    attempt(f"writes {path}", lambda: open(path, "a").write("x"))
    attempt(f"makes {path}", lambda: Path(path).with_name("made").write_text("x"))
shown = json.loads(sys.argv[1])["shown"]
assert Path(shown, "recordings", "run.json").is_file()
for path in [shown, *glob.glob(shown + "/**", recursive=True)]:
    attempt(f"changes {path}", lambda: os.chmod(path, 0o777))
    attempt(f"removes {path}", lambda: os.rename(path, path + "x"))
    if os.path.isfile(path):
        attempt(f"writes {path}", lambda: open(path, "r+b").write(b"x"))
    else:
        attempt(f"makes {path}", lambda: Path(path, "new").write_text("x"))
for family in (socket.AF_INET, socket.AF_INET6, socket.AF_UNIX, socket.AF_NETLINK):
    attempt(f"opens a socket of {family}", lambda: socket.socket(family, socket.SOCK_DGRAM))
attempt("connects", lambda: socket.create_connection(("127.0.0.1", tolerances["port"]), 5))
try:
    pids = os.listdir("/proc")
except OSError:
    pids = [str(os.getppid())]
for pid in filter(str.isdigit, pids):
    if int(pid) != os.getpid():
        attempt(f"ends {pid}", lambda: os.kill(int(pid), signal.SIGTERM))
attempt("sees a token", lambda: int("A_TOKEN" in os.environ or "no"))
return Finding(1, f"got {got}")
"""


def test_it_reaches_no_file_no_network_and_no_process_and_changes_no_recording(
    tmp_path, monkeypatch, recordings
):
    hand_in = tmp_path / "others" / "alice.py"
    hand_in.parent.mkdir()
    hand_in.write_text("x")
    monkeypatch.setenv("A_TOKEN", "secret")
    paths = [str(hand_in), *map(str, (Path.home() / ".profile", tmp_path / "data" / "x"))]
    with socket.create_server(("127.0.0.1", 0)) as server:
        body = REACHES.replace('1 / len("")', "int('')")
        exercise = strange(tmp_path, body, paths=paths, port=server.getsockname()[1])
        (verdict,) = judge(recordings, exercise).verdicts
        server.settimeout(0)
        with pytest.raises(BlockingIOError):
            server.accept()
    assert str(verdict.rationale) == "got []"
    assert [each.name for each in hand_in.parent.iterdir()] == ["alice.py"]


FOR_ALL = "for fd in range(3, 64):\n    try: os.write(fd, {data!r})\n    except OSError: pass\n"
FORGED = {"share": 1.0, "rationale": "x", "evidence": [{"time_s": 1.0, "note": "x", "run": 7}]}
MANY = {"share": 1.0, "rationale": "x", "evidence": [{"time_s": 1.0, "note": "x"}] * 201}
LONG = {"share": 1.0, "rationale": {"key": "{a}" * 50, "values": {"a": "x" * 20_001}}}


def forged(answer, name="hostile", number=0):
    line = json.dumps([number, name, answer]).encode() + b"\n"
    return FOR_ALL.format(data=line) + "os._exit(0)"


ATTACKS = {
    "gigabytes": ("return Finding(1, 'x' * 20_000_000)", "answered with more than 16 MB"),
    "nonsense": (FOR_ALL.format(data=b"\0nonsense\n"), "answered what cannot be used"),
    "another run": (forged({"say": "finding", "finding": FORGED}), "there is no run 7"),
    "much evidence": (forged({"say": "finding", "finding": MANY}), "200 at most"),
    "a long text": (forged({"say": "finding", "finding": LONG}), "20000 characters at most"),
    "another check": (forged({"say": "not over"}, "other"), "nobody asked for the check 'other'"),
    "another round": (forged({"say": "not over"}, number=9), "in round 9"),
    "nothing": ("os._exit(0)", "there is none of the check 'hostile'"),
    "its end": ("os._exit(7)", "ended the process that it ran in (exit code 7)"),
    "a signal": ("os.kill(os.getpid(), 9)", "ended the process that it ran in (signal 9)"),
    "sleep": ("while True: time.sleep(60)", "did not come to an end in 3 s"),
    "a stop": ("os.kill(os.getpid(), signal.SIGSTOP)", "did not come to an end in 3 s"),
    "forks": ("while os.fork() or True: pass", "than it may"),
    "an error": ("raise OSError('odd')", "checks.py, line 10: OSError: odd"),
}
KEPT = ("gigabytes", "nonsense", "sleep")


@pytest.mark.parametrize("what", others_are_more("each takes two processes", ATTACKS, *KEPT))
def test_what_it_does_else_is_the_exercises_fault(tmp_path, monkeypatch, recordings, what):
    body, words = ATTACKS[what]
    exercise = strange(tmp_path, body)
    if "3 s" in words:
        monkeypatch.setattr(asking, "LIMITS", replace(asking.LIMITS, wall_s=3.0))
    with pytest.raises(CheckFailed) as failed:
        judge(recordings, exercise)
    assert words in str(failed.value)
    assert "'hostile'" in str(failed.value)
    assert failed.value.exit_code == 3


def test_what_it_does_when_it_is_imported_is_confined_as_well(tmp_path, monkeypatch):
    mark = tmp_path / "mark"
    code = f"try: Path({str(mark)!r}).touch()\nexcept OSError: os._exit(5)\n"
    with pytest.raises(CheckFailed, match=r"check code of the exercise 'hostile'.*exit code 5"):
        strange(tmp_path, "return Finding(1, 'x')", code)
    assert not mark.exists()


def test_a_tolerance_is_tried_there_and_a_mistake_in_the_code_is_told(tmp_path):
    validator = (
        "@checks.tolerance\ndef size(value):\n    raise ValueError(f'expected 1, not {value}')\n"
    )
    with pytest.raises(ExerciseError, match=r"line \d+: tolerances: size: expected 1, not 2"):
        strange(tmp_path, "return Finding(1, 'x')", validator, size=2)


def test_the_command_line_blames_the_exercise_and_not_the_student(tmp_path, recordings, capsys):
    add_strange(tmp_path, "os._exit(7)")
    save_recordings(recordings, tmp_path / "recording")
    assert main(["check", str(tmp_path / "recording"), "--exercise", "hostile"]) == 3
    said = " ".join(capsys.readouterr().err.split())
    assert said.startswith("The exercise failed; this is not the submission's fault: the check ")


def judged_where(refused, tmp_path, recordings):
    """Judge by the command line on a system that refuses something."""
    save_recordings(recordings, tmp_path / "recording")
    words = ["check", str(tmp_path / "recording"), "--exercise", "hostile", "--json", "result.json"]
    return subprocess.run(
        [sys.executable, REFUSING, refused, sys.executable, "-m", "grader", *words],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )


def test_where_nothing_confines_it_it_is_refused(tmp_path, recordings):
    add_strange(tmp_path, "return Finding(1, 'x')")
    done = judged_where("namespaces,landlock", tmp_path, recordings)
    assert done.returncode == 2, done.stderr
    assert "nothing can confine them here. To get it: Linux 5.13 or later" in done.stderr
    assert not (tmp_path / "result.json").exists()


def test_elsewhere_than_on_linux_it_is_refused(tmp_path, monkeypatch):
    add_strange(tmp_path, "return Finding(1, 'x')")
    monkeypatch.setattr(confined.system, "runs_submissions", lambda: False)
    with pytest.raises(UsageError, match="which takes Linux"):
        load_exercise("hostile")


@pytest.mark.more("the sandbox's own tests are at this level as well")
@pytest.mark.applies(landlock.abi() >= 4, reason="without it TCP is free")
def test_landlock_alone_confines_it_as_well(tmp_path, recordings):
    (tmp_path / "alice.py").write_text("x")
    with socket.create_server(("127.0.0.1", 0)) as server:
        paths = [str(tmp_path / "alice.py"), str(Path.home() / ".profile")]
        add_strange(tmp_path, REACHES, paths=paths, port=server.getsockname()[1])
        done = judged_where("namespaces", tmp_path, recordings)
    assert done.returncode == 0, done.stderr
    (verdict,) = json.loads((tmp_path / "result.json").read_text())["verdicts"]
    assert verdict["rationale"] == "got []"


def test_an_author_is_told_what_a_check_does_when_it_is_asked_again(tmp_path, recordings):
    body = "checks.times = getattr(checks, 'times', 0) + 1\nreturn Finding(1, f'{checks.times}')"
    _, faults = examine(strange(tmp_path, body), recordings)
    assert ["asked again" in str(fault.text) for fault in faults] == [True]


def test_it_names_no_file_but_its_own(tmp_path):
    folder = exercises.write(tmp_path / "odd", exercise="odd", starter="../secret")
    (tmp_path / "data").mkdir()
    commit(folder)
    (added(folder, "odd").parent / "secret").mkdir()
    with pytest.raises(ExerciseError, match="names its own files alone"):
        load_exercise("odd")
