"""Packages that describe robots, as students hand them in, and what is found of them."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

import setuptools  # noqa: F401  once, and not by each copy of this process that runs a setup.py

from grader.exercise.loading import load_exercise
from grader.recording.recording import Recording, Recordings, Run
from grader.scenes.package.examining.main import look
from grader.scenes.package.trace import PackageTrace
from grader.testing.solutions import read_solutions

FOLDER = Path(__file__).parent / "description_package"
EXERCISE = load_exercise("description_package")
SOLUTIONS = {solution.name: solution for solution in read_solutions(EXERCISE)}
REFERENCE = SOLUTIONS["reference"].path
#: The tutorials followed, and what a course makes of them.
HANDED_IN = ("r2d2_tutorial", "urdf_to_package")


def looked_at(path: Path, package: str = "") -> PackageTrace:
    """What is found of a package, without the process that confines who looks."""
    with tempfile.TemporaryDirectory() as scratch:
        return look(path, package, Path(scratch).resolve())


def recorded(trace: PackageTrace) -> Recordings:
    """A trace as a run leaves it."""
    return Recordings(Recording(trace, Run(trace_sha256=trace.sha256()), scene="package"))


def written(folder: Path, files: Mapping[str, str | None], of: Path = REFERENCE) -> Path:
    """A copy of a package with some files written, or taken away."""
    copy = folder / of.name
    shutil.copytree(of, copy, ignore=shutil.ignore_patterns("__pycache__"))
    for name, text in files.items():
        path = copy / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.unlink(missing_ok=True)
        if text is not None:
            path.write_text(text, encoding="utf-8")
    return copy
