"""Extensions, found by the entry points of installed distributions; ours go through the same door.

grader.scenes       what an exercise's `scene:` names: a `grader.recording.subject.Subject`
grader.exercises    a module or package in the exercise's folder
grader.reports      a `grader.reports.Format`
grader.inspections  what an exercise's `inspections:` name: a `grader.scenes.package.inspector.
                    Inspector`
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from functools import cache, lru_cache
from importlib.metadata import EntryPoint, PackageNotFoundError, distribution, entry_points
from pathlib import Path
from typing import Any, Final, Literal

from grader.errors import UsageError

Group = Literal["grader.scenes", "grader.exercises", "grader.reports", "grader.inspections"]
SCENES: Final = "grader.scenes"
EXERCISES: Final = "grader.exercises"
REPORTS: Final = "grader.reports"
INSPECTIONS: Final = "grader.inspections"
#: The distribution that this module is of.
DISTRIBUTION: Final = "turtlesim_py"


def points(group: Group) -> Mapping[str, list[EntryPoint]]:
    """What is installed in a group, by name, ours first; several of a name are a clash.

    A distribution that is found twice on the path counts once.
    """
    # an installation changes the folder; reading all that is installed takes tens of milliseconds
    return _points(group, tuple((folder, _changed_ns(folder)) for folder in sys.path))


def find(group: Group, name: str) -> EntryPoint:
    """The entry point of a name. A name of ours is ours, whatever else is installed.

    Raises:
        KeyError: there is none, or there are several.
    """
    if name in (ours := _ours(group)):
        return ours[name]
    found = points(group).get(name, [])
    if len(found) == 1:
        return found[0]
    if found:
        raise KeyError(f"{group}: several are called {name!r}: {', '.join(map(told, found))}")
    raise KeyError(f"{group}: there is no {name!r}; there are: {', '.join(points(group))}")


def load(group: Group, name: str) -> Any:
    """The object that the entry point of a name is for.

    Raises:
        KeyError: see `find`.
        UsageError: it cannot be imported; the text says why, and whose it is.
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
            point=told(point),
            error=f"{type(error).__name__}: {error}",
        ) from error


def told(point: EntryPoint) -> str:
    """Where an entry point leads, and whose it is."""
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


def _changed_ns(folder: str) -> int:
    try:
        return Path(folder).stat().st_mtime_ns
    except OSError:
        return 0


@lru_cache(maxsize=8)
def _points(group: Group, _path: tuple[tuple[str, int], ...]) -> Mapping[str, list[EntryPoint]]:
    found: dict[str, dict[str, EntryPoint]] = {}
    for point in (*_ours(group).values(), *entry_points(group=group)):
        found.setdefault(point.name, {}).setdefault(told(point), point)
    return {name: list(each.values()) for name, each in sorted(found.items())}
