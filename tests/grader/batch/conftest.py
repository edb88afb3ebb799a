"""A small class, and an exercise of its own to judge it by, for whatever grades whole classes."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path

import pytest

from grader import content, grading, judging
from grader.batch import grade, pool
from grader.batch.pool import Answer, Done, Task
from grader.cli import main
from grader.recording.recording import Recordings
from grader.submission.start import Submission
from tests import once
from tests.grader.batch.classes import ROOT, Class
from tests.grader.batch.names import accented

CONTROLLER = (ROOT / "tests" / "submissions" / "square_controller.py").read_text(encoding="utf-8")
HANDED_IN = {
    "crashes": "import rclpy\nx = 1 / 0\n",
    "leaves": "raise SystemExit(3)\n",
    "right": CONTROLLER,
    "twin": CONTROLLER,
}
#: One run of each, and no points for others.
QUICK = """exercise: own_square
varied_runs: {count: 0}
points: {drives: 5, sides: 25, corners: 20, straight: 10, returns: 15, stops: 10}
"""


def _make(folder: Path) -> None:
    handed_in = folder / "handed_in"
    (handed_in / "nobody").mkdir(parents=True)
    for name, source in HANDED_IN.items():
        (handed_in / f"{name}.py").write_text(source, encoding="utf-8")
    own = folder / "own_square"  # not an installed one: it has to be where it is judged
    leave = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "grader" / "exercises" / "square", own, ignore=leave)
    described = own / "exercise.yaml"
    text = described.read_text(encoding="utf-8")
    described.write_text(text.replace("exercise: square", "exercise: own_square", 1), "utf-8")
    (own / "quick.yaml").write_text(QUICK, "utf-8")


@pytest.fixture(scope="session")
def small_class() -> Class:
    """Four who have handed in something, and one who has not; nobody changes it."""
    folder = once.folder(_make, "a small class", HANDED_IN, QUICK)
    return Class(folder / "handed_in", folder / "own_square" / "quick.yaml")


def _grade(small_class: Class, folder: Path, *words: str) -> None:
    # one at a time: another worker of the tests has the other core
    command = small_class.command(folder / "class", *words, "--jobs", "1")
    assert main(command[command.index("batch") :]) == 0


@pytest.fixture(scope="session")
def graded(small_class: Class) -> Path:
    """The same class, graded in one go on this machine; nobody changes it."""
    return once.folder(partial(_grade, small_class), "graded", HANDED_IN, QUICK) / "class"


def _make_with_names(small: Class, folder: Path) -> None:
    accented.hand_in(folder / "handed_in")
    words = [str(folder / "handed_in"), "--out", str(folder / "class"), "--jobs", "1"]
    assert main(["batch", *words, "--exercise", str(small.exercise)]) == 0


@pytest.fixture(scope="session")
def with_names(small_class: Class) -> Class:
    """What was handed in, and the exercise; beside it `class`, graded. Nobody changes it."""
    text = Path(accented.__file__).read_text("utf-8")
    folder = once.folder(partial(_make_with_names, small_class), "a class with names", text)
    return Class(folder / "handed_in", small_class.exercise)


@pytest.fixture(scope="module")
def as_recorded(with_names: Class) -> Iterator[None]:
    """Whatever `grader batch` would run of this class is taken from its recordings, as they are."""
    known: dict[str, Recordings] = {}
    for folder in (with_names.handed_in.parent / "class" / "store").glob("*/*/recording"):
        found = judging.load_recordings(folder)
        assert found.nominal.provenance is not None
        known[found.nominal.provenance.submission_sha256] = found

    def run_all(submission: Submission, *_: object, **__: object) -> Recordings:
        assert submission.copy is not None
        return known[content.of_folder(submission.copy.folder)]

    def work(tasks: Iterable[Task], *_: object, **__: object) -> Iterator[Done]:
        for task in tasks:
            grade.make(task)
            yield task, Answer("done")

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(grading, "run_all", run_all)
        patch.setattr(pool, "work", work)
        yield
