"""A small class, and an exercise of its own to judge it by, for whatever grades whole classes."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

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


@pytest.fixture(scope="session")
def small_class(tmp_path_factory: pytest.TempPathFactory) -> Class:
    """Four who have handed in something, and one who has not."""
    folder = tmp_path_factory.mktemp("class")
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
    return Class(handed_in, own / "quick.yaml")


@pytest.fixture(scope="session")
def graded(small_class: Class, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same class, graded in one go on this machine."""
    out = tmp_path_factory.mktemp("graded") / "whole"
    call = small_class.grade(out)
    assert call.returncode == 0, call.stderr
    return out
