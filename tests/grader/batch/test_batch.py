"""`grader batch` on a small class of real submissions, which real workers run."""

from __future__ import annotations

import csv
import io
import os
import shutil
import signal
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import replace
from pathlib import Path

import psutil
import pytest

from grader.batch import pool
from grader.batch.class_file import ClassFile
from grader.batch.entry import Entry, entries
from grader.cli import main
from grader.run.processes import levels
from tests import once
from tests.files import lay
from tests.programs import ROOT

SUBMISSIONS = ROOT / "tests" / "submissions"
RIGHT = (SUBMISSIONS / "quick_spiral.py").read_text(encoding="utf-8")
CRASHES = "import rclpy\nrclpy.init()\nraise RuntimeError('not today')\n"
HANDED_IN: dict[str, str | bytes] = {
    "alice/node.py": RIGHT,
    "bob/node.py": RIGHT,
    "carol.zip": b"PK and nothing more",
    "dave/node.py": CRASHES,
    "erin/notes.txt": "I could not do it.",
}
RUBRIC = "exercise: turtlesim_challenge\nvaried_runs: {count: 1}\n"
PATIENCE_S = 300.0


def start(*words: str | Path) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "grader", "batch", *map(str, words)]
    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.Popen(
        command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=env
    )


def batch(*words: str | Path) -> tuple[int, str]:
    """The verb in this process, its worker in its own; the exit code, and what it said."""
    said = io.StringIO()
    with redirect_stdout(said), redirect_stderr(said):
        # a start of a worker takes longer than what most of these calls leave it to do
        code = main(["batch", *map(str, words), "--jobs", "1"])
    return code, said.getvalue()


def made_together(out: Path) -> dict[str, bytes]:
    """Gradebook and pages: all but what tells of one run."""
    return {
        str(path.relative_to(out)): path.read_bytes()
        for path in sorted(out.rglob("*"))
        if path.is_file() and path.relative_to(out).parts[0] not in ("submissions", "store")
    }


def scores(out: Path) -> dict[str, tuple[str, float | None]]:
    return {entry.id: (entry.state, entry.score) for entry in entries(out)}


def _make(folder: Path) -> None:
    """A class from beginning to end, as a process; the folder has what its tests need."""
    handed_in = lay(folder / "handed_in", HANDED_IN)
    (folder / "rubric.yaml").write_text(RUBRIC)
    words = (handed_in, "--out", folder / "class", "--exercise", folder / "rubric.yaml")
    process = start(*words, "--jobs", "2")
    output, messages = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 0, messages
    (folder / "said.txt").write_text(output + messages)


@pytest.fixture(scope="session")
def made() -> Path:
    """Everybody's: nothing in it is changed."""
    return once.folder(_make, "a class", HANDED_IN, RUBRIC)


@pytest.fixture
def handed_in(made: Path) -> Path:
    return made / "handed_in"


@pytest.fixture
def rubric(made: Path) -> tuple[str, Path]:
    return "--exercise", made / "rubric.yaml"


@pytest.fixture
def graded(made: Path, tmp_path: Path) -> Path:
    """The class, a test's own."""
    return Path(shutil.copytree(made / "class", tmp_path / "graded" / "class"))


def test_who_hands_in_the_same_is_run_once(made: Path) -> None:
    messages = (made / "said.txt").read_text()
    assert "1 hand-in not run: the same content has been run already." in messages
    assert "[5/5]" in messages


def test_progress_names_people_as_they_know_themselves(
    rubric: tuple[str, Path], tmp_path: Path
) -> None:
    handed_in = lay(tmp_path / "handed_in", {"王小明/notes.txt": "I could not do it."})
    _, messages = batch(handed_in, "--out", tmp_path / "class", *rubric)
    assert "[1/1] 王小明: cannot be started" in messages


def test_everybody_gets_what_is_earned_and_one_bad_hand_in_touches_nobody(graded: Path) -> None:
    found = scores(graded)
    assert found["alice"] == found["bob"] == ("judged", 100.0)
    assert found["dave"][0] == "judged"
    assert found["carol"] == found["erin"] == ("unusable", 0.0)


def test_a_student_s_folder_has_what_grader_run_writes(graded: Path) -> None:
    folder = graded / "submissions" / "alice"
    for name in ("result.json", "report.html", "canvas.png", "output.txt"):
        assert (folder / name).stat().st_size or name == "output.txt"
    assert (folder / "recording" / "varied_1" / "metadata.yaml").exists()
    result = Entry.read(folder).result
    assert result is not None and result.handed_in is not None
    assert result.handed_in.id == "alice"


def test_the_gradebook_has_everybody(graded: Path) -> None:
    rows = csv.DictReader((graded / "gradebook.csv").read_text("utf-8-sig").splitlines())
    assert [row["id"] for row in rows] == ["alice", "bob", "carol", "dave", "erin"]


def test_a_second_call_runs_nothing_and_changes_nothing(
    handed_in: Path, rubric: tuple[str, Path], graded: Path
) -> None:
    before = made_together(graded)
    when = (graded / "submissions" / "alice" / "result.json").stat().st_mtime_ns
    code, messages = batch(handed_in, "--out", graded, *rubric)
    assert (code, "5 hand-ins of 5 graded before." in messages) == (0, True), messages
    assert (graded / "submissions" / "alice" / "result.json").stat().st_mtime_ns == when
    assert made_together(graded) == before


def test_who_hands_in_once_more_is_graded_once_more_and_nobody_else(
    rubric: tuple[str, Path], graded: Path, tmp_path: Path
) -> None:
    later = lay(tmp_path / "handed_in", {**HANDED_IN, "dave/node.py": RIGHT})
    code, messages = batch(later, "--out", graded, *rubric)
    assert (code, "4 hand-ins of 5 graded before." in messages) == (0, True), messages
    assert scores(graded)["dave"] == ("judged", 100.0)
    assert "1 hand-in not run" in messages  # what alice handed in is what dave has now


def test_another_exercise_does_not_come_into_the_same_folder(handed_in: Path, graded: Path) -> None:
    before = made_together(graded)
    code, messages = batch(handed_in, "--out", graded, "--exercise", "square")
    assert code == 2
    assert "was graded by something else (the exercise" in messages
    assert made_together(graded) == before


def test_a_changed_rubric_is_to_be_looked_at_first(
    handed_in: Path, graded: Path, tmp_path: Path
) -> None:
    changed = tmp_path / "new.yaml"
    changed.write_text(f"{RUBRIC}points: {{moves: 6}}\n")
    code, messages = batch(handed_in, "--out", graded, "--exercise", changed)
    assert (code, "grader batch --regrade" in messages) == (2, True), messages


def test_who_is_named_by_again_is_run_again(
    handed_in: Path, rubric: tuple[str, Path], graded: Path
) -> None:
    when = {
        name: (graded / "submissions" / name / "result.json").stat().st_mtime_ns
        for name in ("alice", "dave")
    }
    code, messages = batch(handed_in, "--out", graded, *rubric, "--again", "dave")
    assert (code, "4 hand-ins of 5 graded before." in messages) == (0, True), messages
    now = {
        name: (graded / "submissions" / name / "result.json").stat().st_mtime_ns for name in when
    }
    assert (now["alice"], now["dave"] > when["dave"]) == (when["alice"], True)
    code, messages = batch(handed_in, "--out", graded, *rubric, "--again", "nobody")
    assert (code, "there is no hand-in of this name" in messages) == (2, True)


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="a system without kill -9")
def test_what_kill_9_interrupts_goes_on_and_comes_out_the_same(
    handed_in: Path, rubric: tuple[str, Path], graded: Path, tmp_path: Path
) -> None:
    out = tmp_path / "class"
    process = start(handed_in, "--out", out, *rubric, "--jobs", "2")
    assert process.stderr is not None
    for line in process.stderr:
        if "[3/5]" in line:
            break
    family = [process, *psutil.Process(process.pid).children(recursive=True)]
    process.kill()
    process.communicate()
    gone, left = psutil.wait_procs(family[1:], timeout=60)
    assert (len(gone), left) == (len(family) - 1, [])
    code, messages = batch(handed_in, "--out", out, *rubric)
    assert (code, "graded before." in messages) == (0, True), messages
    assert made_together(out) == made_together(graded)
    assert scores(out) == scores(graded)


MORE = {**HANDED_IN, "erin/node.py": CRASHES + "# by erin\n"}


@pytest.mark.skipif(levels.here().level != "namespaces", reason="there is nothing to refuse")
@pytest.mark.parametrize(
    ("refused", "why"),
    [
        (
            "namespaces",
            "isolation by namespaces, at which this class is graded, is not to be had here: "
            "namespaces of users and networks are refused",
        ),
        (
            "mount at present",
            "whether isolation by namespaces is to be had could not be told in 3 tries: "
            "mount: Cannot allocate memory",
        ),
    ],
)
def test_what_a_worker_cannot_confine_as_the_class_is_not_graded_and_told_why(
    rubric: tuple[str, Path],
    graded: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    refused: str,
    why: str,
) -> None:
    refusing = (str(ROOT / "tests" / "refusing.py"), refused, sys.executable)
    monkeypatch.setattr(pool, "_COMMAND", (*refusing, *pool._COMMAND))
    before = scores(graded)
    words = (lay(tmp_path / "handed_in", MORE), "--out", graded, *rubric)
    code, messages = batch(*words)
    assert code == 3, messages
    assert scores(graded) == {**before, "erin": ("failed", None)}
    assert str(Entry.read(graded / "submissions" / "erin").message) == why
    assert why in (graded / "index.html").read_text("utf-8")
    monkeypatch.undo()
    code, messages = batch(*words, "--again", "failed")
    assert (code, scores(graded)["erin"][0]) == (0, "judged"), messages


@pytest.mark.skipif(levels.here().level != "namespaces", reason="nothing is better")
def test_a_class_goes_on_at_the_level_at_which_it_was_begun_or_not_at_all(
    handed_in: Path,
    rubric: tuple[str, Path],
    graded: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    begun = ClassFile.read(graded)
    assert begun.isolation == "namespaces"
    words = (lay(tmp_path / "handed_in", MORE), "--out", graded, *rubric)
    with monkeypatch.context() as less:
        less.setattr(levels, "_found", {})
        less.setattr(
            levels, "_find_level", lambda *_: levels.Level("", refused={"namespaces": "no"})
        )
        code, messages = batch(*words)
        assert code == 2
        assert "at which this class is graded, is not to be had here: no. To get it:" in messages
        assert "--again all" in messages
        code, messages = batch(handed_in, "--out", graded, *rubric)  # there is nothing to run
        assert code == 0, messages
    replace(begun, isolation="limits").put(graded)
    with monkeypatch.context() as asked:
        asked.setattr(levels, "_least", "")  # which is for all of a process
        code, messages = batch(*words, "--isolation", "landlock")
    assert code == 2
    assert "(the isolation: there limits, here landlock)" in messages
    code, messages = batch(*words)
    assert (code, scores(graded)["erin"][0]) == (0, "judged"), messages
    result = Entry.read(graded / "submissions" / "erin").result
    assert result is not None and result.run.isolation.startswith("limits")


def test_who_is_no_longer_among_the_submissions_is_set_aside_and_comes_back_without_a_run(
    handed_in: Path, rubric: tuple[str, Path], graded: Path, tmp_path: Path
) -> None:
    fewer = lay(tmp_path / "fewer", {"alice/node.py": RIGHT})
    code, messages = batch(fewer, "--out", graded, *rubric)
    assert (code, "4 hand-ins in" in messages, "bob, carol, dave, erin" in messages) == (0, 1, 1)
    assert scores(graded).keys() == {"alice"}
    assert (graded / "aside" / "dave" / "result.json").exists()
    code, messages = batch(handed_in, "--out", graded, *rubric)
    assert (code, len(scores(graded))) == (0, 5), messages
    assert "not run: the same content has been run already." in messages


def test_the_folder_of_a_class_is_no_submissions(graded: Path) -> None:
    before = made_together(graded)
    for words in ((graded, "--out", graded), (graded, "--out", graded.parent / "other")):
        code, messages = batch(*words)
        assert (code, "is the folder of a class" in messages) == (2, True), messages
    assert made_together(graded) == before
    assert not (graded.parent / "other").exists()


def test_a_refused_call_leaves_no_class_behind(tmp_path: Path) -> None:
    code, messages = batch(tmp_path / "nowhere", "--out", tmp_path / "class")
    assert (code, (tmp_path / "class").exists()) == (2, False), messages
