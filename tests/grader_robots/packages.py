"""Packages that describe robots, as students hand them in, and what is found of them."""

import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from unittest.mock import patch

from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.exercise.result.result import Result
from grader.judging import judge
from grader.recording.recording import Recording, Recordings, Run
from grader.submission import inspector
from grader.submission.answer import Inspection, decode
from grader.submission.examining import steps
from grader.submission.examining.main import inspect
from grader.submission.trace import PackageTrace, encode
from grader.testing.solutions import read_solutions
from tests import apart, once
from tests.hand_ins import SUBMISSIONS

FOLDER = SUBMISSIONS / "description_package"
EXERCISE = load_exercise("description_package")
SOLUTIONS = {solution.name: solution for solution in read_solutions(EXERCISE)}
REFERENCE = SOLUTIONS["reference"].path
#: What examines packages here.
INSPECTORS = inspector.places(("robot_description",))
#: The tutorials followed, and what a course makes of them.
HANDED_IN = ("r2d2_tutorial", "urdf_to_package")


def looked_at(path: Path, package: str = "", **limits: float) -> PackageTrace:
    """What is found of a package, without what confines the process that looks."""
    return inspected(path, **limits, package=package, inspectors=INSPECTORS).trace


def inspected(
    root: Path,
    cpu_s: float = steps.LIMITS.cpu_s,
    wall_s: float = steps.LIMITS.wall_s,
    **order: object,
) -> Inspection:
    """The answer to an order for an inspection; see `grader.submission.examining.main.inspect`.

    Args:
        cpu_s, wall_s: so much time may a step take.
    """
    process = _looking()
    assert process.stdin is not None
    assert process.stdout is not None
    try:
        process.stdin.write(json.dumps([str(root), cpu_s, wall_s, order]).encode() + b"\n")
        process.stdin.flush()
        size = int.from_bytes(process.stdout.read(8), "big")
        assert size, "what looks at packages has died"
        return decode(process.stdout.read(size))
    except BaseException:  # a test's time is over: nobody else gets its answer
        process.kill()
        _looking.cache_clear()
        raise


@cache
def _looking() -> subprocess.Popen[bytes]:
    """A process for one package after the other, small and without threads.

    Each step is made by a copy, which the tests' own process has too much memory for, and threads
    whose locks it would wait for.
    """
    words = [sys.executable, "-c", f"from {__name__} import look_without_end as main; main()"]
    process = subprocess.Popen(words, cwd=once.ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    apart.at_the_end(process.communicate)
    return process


def look_without_end() -> None:
    """Look at each package that is named on standard input."""
    import setuptools  # noqa: F401  once, and not by each copy that runs a setup.py

    for line in sys.stdin:
        root, cpu_s, wall_s, order = json.loads(line)
        limits = replace(steps.LIMITS, cpu_s=cpu_s, wall_s=wall_s)
        with patch.object(steps, "LIMITS", limits), tempfile.TemporaryDirectory() as scratch:
            told = encode(inspect(Path(root), Path(scratch).resolve(), **order))
        sys.stdout.buffer.write(len(told).to_bytes(8, "big") + told)
        sys.stdout.buffer.flush()


def recorded(trace: PackageTrace) -> Recordings:
    """A trace as a run leaves it."""
    return Recordings(Recording(trace, Run(trace_sha256=trace.sha256()), scene="package"))


def graded(path: Path, exercise: Exercise = EXERCISE) -> Result:
    return judge(recorded(looked_at(path)), exercise)


def lost(result: Result) -> dict[str, float]:
    """The checks that lose points, with the share that is left."""
    return {v.check: v.score / v.max_score for v in result.verdicts if not v.passed}


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
