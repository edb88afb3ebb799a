"""A small class, and an exercise of its own to judge it by, for whatever grades whole classes."""

from __future__ import annotations

import io
import shutil
from contextlib import redirect_stderr, redirect_stdout
from functools import partial
from pathlib import Path

import pytest

from grader.cli import main
from tests import once
from tests.grader.batch import named_class
from tests.grader.batch.classes import ROOT, Class

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


def _make_named(small: Class, folder: Path) -> None:
    named_class.hand_in(folder / "handed_in")
    hidden = ["--pseudonyms", folder / "keys" / "key", "--names", folder / "named"]
    said = io.StringIO()
    for words in (["--out", folder / "class"], ["--out", folder / "hidden", *hidden]):
        words += [folder / "handed_in", "--jobs", "1", "--exercise", small.exercise]
        with redirect_stderr(said), redirect_stdout(said):
            assert main(["batch", *map(str, words)]) == 0
    (folder / "said.txt").write_text(said.getvalue(), "utf-8")


@pytest.fixture(scope="session")
def named(small_class: Class) -> Path:
    """A folder: `handed_in`; graded into `class`, and under pseudonyms into `hidden`, `named`.

    `said.txt` has what the calls have printed. Nobody changes it.
    """
    text = Path(named_class.__file__).read_text("utf-8")
    return once.folder(partial(_make_named, small_class), "a class with names", text, QUICK)
