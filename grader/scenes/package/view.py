"""A package for people: its robot, what its launch files would start, and remarks."""

from __future__ import annotations

from typing import Final

from grader.language.phrase import say
from grader.scenes.package import described, launched
from grader.scenes.package.said import phrase_of
from grader.scenes.package.trace import PackageTrace
from grader.scenes.view import Plane, View

_SIZE_PX: Final = 500
PLANE: Final = Plane(_SIZE_PX, 1.0, float(_SIZE_PX))


def view(trace: PackageTrace) -> View:
    """Nothing moves: the robot, its links, and what the launch files would start."""
    robot = tuple(p for p in (described.solid(trace), described.links(trace)) if p is not None)
    return View(
        (),
        (),
        "#ffffff",
        None,
        (),
        (),
        drawn=(described.words(trace),),
        parts=(*robot, *launched.tables(trace)),
    )


def remarks(trace: PackageTrace) -> list[str]:
    """What a reader of the result should know."""
    if trace.setup is None:
        return []
    found: list[str] = [
        say(
            "{file} could not be evaluated: {why}",
            file=launch.file,
            why=phrase_of(launch.problem.text),
        )
        for launch in trace.launches
        if launch.problem is not None and launch.problem.kind == "unknown"
    ]
    found += [
        say("{file}: {remark}", file=launch.file, remark=phrase_of(remark))
        for launch in trace.launches
        for remark in launch.remarks
    ]
    if trace.others:
        beside = ", ".join(trace.others[:10])
        found.append(
            say(
                "judged was the package {name}; beside it lie {others}",
                name=trace.setup.name,
                others=beside,
            )
        )
    return found
