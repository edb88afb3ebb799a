"""A small class, and an exercise of its own to judge it by, for whatever grades whole classes."""

import shutil
import subprocess
from functools import partial
from pathlib import Path

import pytest

from tests import once
from tests.files import lay
from tests.grader_class import named_class
from tests.grader_class.classes import CONTROLLER, DEADLINE_S, ENV, Class, batch, command, work_here
from tests.programs import ROOT

HANDED_IN = {
    "broken.zip": b"PK and nothing more",
    "crashes.py": "import rclpy\nx = 1 / 0\n",
    "leaves.py": "raise SystemExit(3)\n",
    "right/square.py": CONTROLLER,
    "twin/square.py": CONTROLLER,
}
#: One run of each, and no points for others.
QUICK = """exercise: own_square
varied_runs: {count: 0}
points: {drives: 5, sides: 25, corners: 20, straight: 10, returns: 15, stops: 10}
"""


def _make(folder):
    (lay(folder / "handed_in", HANDED_IN) / "nobody").mkdir()
    own = folder / "own_square"  # not an installed one: it has to be where it is judged
    leave = shutil.ignore_patterns("__pycache__")
    shutil.copytree(ROOT / "grader" / "exercises" / "square", own, ignore=leave)
    described = own / "exercise.yaml"
    text = described.read_text(encoding="utf-8")
    described.write_text(text.replace("exercise: square", "exercise: own_square", 1), "utf-8")
    (own / "quick.yaml").write_text(QUICK, "utf-8")


@pytest.fixture(scope="session")
def small_class():
    """Five who have handed in something, and one who has not; nobody changes it."""
    folder = once.folder(_make, "a small class", HANDED_IN, QUICK)
    return Class(folder / "handed_in", folder / "own_square" / "quick.yaml")


def _grade(small_class, folder):
    words = command(*small_class.words(folder / "class"), "--jobs", "2")
    done = subprocess.run(words, env=ENV, text=True, capture_output=True, timeout=DEADLINE_S)
    assert done.returncode == 0, done.stderr
    (folder / "said.txt").write_text(done.stdout + done.stderr, "utf-8")


@pytest.fixture(scope="session")
def graded(small_class):
    """The same class, graded by a process on this machine; nobody changes it.

    `said.txt` beside it has what the call has printed.
    """
    return once.folder(partial(_grade, small_class), "graded", HANDED_IN, QUICK) / "class"


@pytest.fixture
def out(graded, tmp_path):
    return Path(shutil.copytree(graded, tmp_path / "graded" / "class"))


@pytest.fixture
def in_process(monkeypatch):
    work_here(monkeypatch)


def _make_named(small, folder):
    named_class.hand_in(folder / "handed_in")
    hidden = ["--pseudonyms", folder / "keys" / "key", "--names", folder / "named"]
    said = []
    with pytest.MonkeyPatch.context() as patch:
        work_here(patch)
        for more in (["--out", folder / "class"], ["--out", folder / "hidden", *hidden]):
            code, text = batch(folder / "handed_in", "--exercise", small.exercise, *more)
            assert code == 0, text
            said.append(text)
    (folder / "said.txt").write_text("".join(said), "utf-8")


@pytest.fixture(scope="session")
def named(small_class):
    """A folder: `handed_in`; graded into `class`, and under pseudonyms into `hidden`, `named`.

    `said.txt` has what the calls have printed. Nobody changes it.
    """
    text = Path(named_class.__file__).read_text("utf-8")
    return once.folder(partial(_make_named, small_class), "a class with names", text, QUICK)
