"""Packages that describe robots, as students hand them in, and what is found of them."""

import shutil
from collections.abc import Mapping
from pathlib import Path

from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.exercise.result.result import Result
from grader.judging import judge
from grader.recording.recording import Recording, Recordings, Run
from grader.submission import inspector
from grader.submission.package_trace import PackageTrace
from grader.testing.solutions import read_solutions
from tests.hand_ins import SUBMISSIONS
from tests.inspecting import inspected

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
