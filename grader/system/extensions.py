"""Extensions, found by the entry points of installed distributions, as ours are.

grader.scenes       a `grader.scenes.subject.Subject`, named by an exercise's `scene:`
grader.exercises    a module or package in the exercise's folder
grader.reports      a `grader.reports.Format`
grader.inspections  what an exercise's `inspections:` name: a `grader.submission.inspector.
                    Inspector`
grader.diagnoses    a `grader.exercise.result.diagnosis.Diagnoser`, for the first line
grader.verbs        a verb of the command line: a module with `add_arguments` and `main`, whose
                    docstring's first line is its help; NEEDS_LINUX where it runs submissions
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from functools import cache, lru_cache
from importlib.metadata import EntryPoint, PackageNotFoundError, distribution, entry_points
from typing import Any, Final, Literal

from grader.errors import UsageError

Group = Literal[
    "grader.scenes",
    "grader.exercises",
    "grader.reports",
    "grader.inspections",
    "grader.diagnoses",
    "grader.verbs",
]
SCENES: Final = "grader.scenes"
EXERCISES: Final = "grader.exercises"
REPORTS: Final = "grader.reports"
INSPECTIONS: Final = "grader.inspections"
DIAGNOSES: Final = "grader.diagnoses"
VERBS: Final = "grader.verbs"
#: The exercise that is meant where none is named.
DEFAULT_EXERCISE: Final = "turtlesim_challenge"
#: The distribution that this module is of.
DISTRIBUTION: Final = "turtlesim_py"


def points(group: Group) -> Mapping[str, list[EntryPoint]]:
    """Return the entry points of a group by name, ours first; several of a name are a clash.

    A distribution that is found twice on the path counts once.
    """
    return _points(group, tuple(sys.path))


def is_there(group: Group, name: str) -> bool:
    """Whether there is an entry point of a name; ours are found sooner than others'."""
    return name in _ours(group) or name in points(group)


def find(group: Group, name: str) -> EntryPoint:
    """Return the entry point of a name. A name of ours is ours, whatever else is installed.

    Raises:
        KeyError: there is none, or there are several.
    """
    if name in (ours := _ours(group)):
        return ours[name]
    found = points(group).get(name, [])
    if len(found) == 1:
        return found[0]
    if found:
        raise KeyError(f"{group}: several are called {name!r}: {', '.join(map(described, found))}")
    raise KeyError(f"{group}: there is no {name!r}; there are: {', '.join(points(group))}")


def load(group: Group, name: str) -> Any:
    """Load the object of an entry point.

    Raises:
        KeyError: see `find`.
        UsageError: it cannot be imported; the text has the reason and the distribution.
    """
    point = find(group, name)
    if name in _ours(group):
        return _loaded(point)
    try:
        return _loaded(point)
    except Exception as error:  # whatever another package does when it is imported
        raise UsageError(
            "the extension {name}, {point}, cannot be loaded: {error}",
            name=name,
            point=described(point),
            error=f"{type(error).__name__}: {error}",
        ) from error


def load_all(group: Group) -> list[Any]:
    """Load the objects of all entry points of a group; see `load`."""
    return [load(group, name) for name in points(group)]


def described(point: EntryPoint) -> str:
    """Return the object and the distribution of an entry point, for a message."""
    whose = point.dist.name if point.dist else "an unknown package"
    return f"{point.value} of {whose}"


@cache
def _loaded(point: EntryPoint) -> Any:
    return point.load()


@cache
def _ours(group: Group) -> Mapping[str, EntryPoint]:
    try:
        found = distribution(DISTRIBUTION).entry_points
    except PackageNotFoundError:
        return {}
    return {point.name: point for point in found if point.group == group}


@lru_cache(maxsize=1)
def _installed(_path: tuple[str, ...]) -> Any:
    """Read the entry points of all groups, which takes tens of milliseconds; see `select`."""
    return entry_points()


@lru_cache(maxsize=8)
def _points(group: Group, path: tuple[str, ...]) -> Mapping[str, list[EntryPoint]]:
    ours = _ours(group)
    found = {name: [point] for name, point in ours.items()}
    for point in _installed(path).select(group=group):
        if point.name not in ours or point.value != ours[point.name].value:
            found.setdefault(point.name, []).append(point)
    return {name: _each_once(points) for name, points in sorted(found.items())}


def _each_once(points: list[EntryPoint]) -> list[EntryPoint]:
    # whose one is, stands in a file of its distribution that is long to parse
    if len(points) == 1:
        return points
    return list({described(point): point for point in reversed(points)}.values())[::-1]
