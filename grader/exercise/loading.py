"""An exercise: a folder with exercise.yaml (points, limits, tolerances) and checks.py."""

from __future__ import annotations

import importlib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import yaml

from grader.errors import ExerciseError
from grader.exercise.check import Checks
from grader.scenes import NAMES as SCENES
from grader.scenes import load_scene
from grader.scenes.scene import Limits, Start

DEFAULT = "turtlesim_challenge"


@dataclass(frozen=True)
class VariedRuns:
    """Further runs that start elsewhere: how many, and how far from the centre [m]."""

    count: int = 0
    seed: int = 0
    nearest_m: float = 0.0
    farthest_m: float = 0.0


@dataclass(frozen=True)
class Exercise:
    """What is asked and how it is weighed.

    Attributes:
        name: the folder's name, as `--exercise` takes it.
        title: what a student reads.
        limits: when a run ends.
        varied: further runs that start elsewhere.
        points: check name -> points, in the order of the report.
        tolerances: what the checks may read; their names are the checks' own business.
        checks: the exercise's check functions.
        scene: the name of what runs beside the submission.
    """

    name: str
    title: str
    limits: Limits
    varied: VariedRuns
    points: Mapping[str, float]
    tolerances: Mapping[str, Any]
    checks: Checks
    scene: str = "turtlesim"

    @property
    def max_score(self) -> float:
        """The sum of all points."""
        return round(sum(self.points.values()), 2)

    def starts(self, seed: int | None = None) -> list[Start]:
        """Where the varied runs start; None takes the exercise's own seed."""
        varied = self.varied
        used = varied.seed if seed is None else seed
        scene = load_scene(self.scene)
        return scene.starts(varied.count, used, varied.nearest_m, varied.farthest_m)


def names() -> list[str]:
    """The exercises that are installed."""
    folder = files("grader") / "exercises"
    return sorted(p.name for p in folder.iterdir() if (p / "exercise.yaml").is_file())


def load_exercise(name_or_file: str) -> Exercise:
    """Load an installed exercise by name, or an edited copy of its exercise.yaml by path.

    What an edited copy leaves out of `limits` and `tolerances` stays as it is in the original.

    Raises:
        ExerciseError: there is no such exercise, or the file does not describe one.
    """
    path = Path(name_or_file)
    if path.suffix in (".yaml", ".yml"):
        try:
            edited = _read(path.read_text(encoding="utf-8"))
            return _build(_merged(_installed(edited.get("exercise")), edited))
        except OSError as error:
            raise ExerciseError(f"cannot read the exercise {path}: {error.strerror}") from None
        except (ExerciseError, ValueError) as error:
            raise ExerciseError(f"{path} is not an exercise: {error}") from None
    if name_or_file in names():
        return _build(_installed(name_or_file))
    raise ExerciseError(
        f"there is no exercise {name_or_file!r}; there are: {', '.join(names())}. "
        "An edited copy is given as the path of its exercise.yaml."
    )


def _installed(name: object) -> dict[str, Any]:
    if name not in names():
        raise ExerciseError(f"exercise: expected one of {', '.join(names())}, found {name!r}")
    return _read((files("grader") / "exercises" / str(name) / "exercise.yaml").read_text())


def _read(text: str) -> dict[str, Any]:
    try:
        data = yaml.safe_load(text)
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else "?"
        raise ExerciseError(f"line {line}: {error.problem}") from None
    except yaml.YAMLError as error:
        raise ExerciseError(str(error).splitlines()[0]) from None
    if not isinstance(data, dict):
        raise ExerciseError("expected keys such as exercise, limits, points")
    return data


def _merged(original: dict[str, Any], edited: dict[str, Any]) -> dict[str, Any]:
    """The original with what was edited; every key must exist there, with a like value."""
    merged = {**original, **edited}
    for part in ("limits", "tolerances", "varied_runs"):
        known, given = original.get(part, {}), edited.get(part, {})
        if not isinstance(given, dict):
            raise ExerciseError(f"{part}: expected names with numbers, found {given!r}")
        for key, value in given.items():
            if key not in known:
                raise ExerciseError(f"{part}: unknown {key!r}; there are {', '.join(known)}")
            if not _alike(value, known[key]):
                raise ExerciseError(f"{part}: {key}: expected e.g. {known[key]!r}, found {value!r}")
        merged[part] = {**known, **given}
    return merged


def _alike(value: object, example: object) -> bool:
    if isinstance(example, list):
        return isinstance(value, list) and all(_alike(v, example[0]) for v in value)
    if isinstance(example, bool) or not isinstance(example, int | float):
        return type(value) is type(example)
    return _is_amount(value)


def _is_amount(value: object) -> bool:
    """A number that is finite and not negative."""
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and math.isfinite(value) and value >= 0  # type: ignore[arg-type, operator]


def _build(data: dict[str, Any]) -> Exercise:
    name = data["exercise"]
    checks = importlib.import_module(f"grader.exercises.{name}.checks").checks
    points = data["points"]
    if not isinstance(points, dict) or not points:
        raise ExerciseError("points: expected check names with points")
    known = [check.name for check in checks]
    for check, value in points.items():
        if check not in known:
            raise ExerciseError(
                f"points: no check is named {check!r}; there are {', '.join(known)}"
            )
        if not _is_amount(value):
            raise ExerciseError(f"points: {check}: expected a number from 0, found {value!r}")
    scene = data.get("scene", "turtlesim")
    if scene not in SCENES:
        raise ExerciseError(f"scene: expected one of {', '.join(SCENES)}, found {scene!r}")
    return Exercise(
        name=name,
        title=str(data["title"]),
        limits=Limits(**{key: float(value) for key, value in data["limits"].items()}),
        varied=VariedRuns(**data.get("varied_runs", {})),
        points={check: float(value) for check, value in points.items()},
        tolerances=data.get("tolerances", {}),
        checks=checks,
        scene=scene,
    )
