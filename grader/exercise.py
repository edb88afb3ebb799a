"""An exercise: a folder with exercise.yaml (points, limits, tolerances) and checks.py."""

from __future__ import annotations

import importlib
import math
import random
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import yaml

from grader.check import Checks
from grader.errors import UsageError
from grader.recording import Start
from turtlesim_py.world.turtle import SIZE_M

DEFAULT = "turtlesim_challenge"


@dataclass(frozen=True)
class Limits:
    """When a run ends, in simulated seconds."""

    first_motion_s: float
    rest_s: float
    total_s: float


@dataclass(frozen=True)
class VariedRuns:
    """Further runs that start elsewhere: how many, and how far from the centre [m]."""

    count: int = 0
    seed: int = 0
    nearest_m: float = 0.0
    farthest_m: float = 0.0

    def starts(self, seed: int | None = None) -> list[Start]:
        """Where they start; the same for the same seed."""
        chance = random.Random(self.seed if seed is None else seed)
        starts = []
        for _ in range(self.count):
            distance = chance.uniform(self.nearest_m, self.farthest_m)
            angle = chance.uniform(-math.pi, math.pi)
            x, y = (SIZE_M / 2 + distance * f(angle) for f in (math.cos, math.sin))
            theta = chance.uniform(-math.pi, math.pi)
            starts.append(Start(round(x, 3), round(y, 3), round(theta, 3)))
        return starts


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
    """

    name: str
    title: str
    limits: Limits
    varied: VariedRuns
    points: Mapping[str, float]
    tolerances: Mapping[str, Any]
    checks: Checks


def names() -> list[str]:
    """The exercises that are installed."""
    folder = files("grader") / "exercises"
    return sorted(p.name for p in folder.iterdir() if (p / "exercise.yaml").is_file())


def load(name_or_file: str) -> Exercise:
    """Load an installed exercise by name, or an edited copy of its exercise.yaml by path.

    Raises:
        UsageError: there is no such exercise, or the file does not describe one.
    """
    path = Path(name_or_file)
    if path.suffix in (".yaml", ".yml"):
        try:
            text = path.read_text(encoding="utf-8")
        except OSError as error:
            raise UsageError(f"cannot read the exercise {path}: {error.strerror}") from None
    elif name_or_file in names():
        text = (files("grader") / "exercises" / name_or_file / "exercise.yaml").read_text()
    else:
        raise UsageError(
            f"there is no exercise {name_or_file!r}; there are: {', '.join(names())}. "
            "An edited copy is given as the path of its exercise.yaml."
        )
    try:
        return _parse(yaml.safe_load(text))
    except (yaml.YAMLError, KeyError, TypeError, ValueError) as error:
        raise UsageError(f"{name_or_file} is not an exercise: {error!r}") from None


def _parse(data: dict[str, Any]) -> Exercise:
    name = data["exercise"]
    if name not in names():
        raise ValueError(f"exercise: expected one of {', '.join(names())}, found {name!r}")
    checks = importlib.import_module(f"grader.exercises.{name}.checks").checks
    points = {str(check): float(value) for check, value in data["points"].items()}
    unknown = points.keys() - {check.name for check in checks}
    if unknown:
        raise ValueError(f"points: no check is named {', '.join(sorted(unknown))}")
    return Exercise(
        name=name,
        title=data["title"],
        limits=Limits(**{key: float(value) for key, value in data["limits"].items()}),
        varied=VariedRuns(**data.get("varied_runs", {})),
        points=points,
        tolerances=data.get("tolerances", {}),
        checks=checks,
    )
