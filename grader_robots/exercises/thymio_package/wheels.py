"""Whether a robot can drive: two wheels on one axle, beside the middle, and a third point below."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import combinations
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from grader import Checks, Finding, Tolerances
from grader.submission import shown
from grader.text import Message, joined, msg
from grader_robots.exercises.description_package.facts import PackageFacts, no_robot, of_package
from grader_robots.exercises.description_package.robots import best_of
from grader_robots.robot_py import kinematics
from grader_robots.robot_py.model import (
    Box,
    Collision,
    Cylinder,
    JointType,
    Link,
    Mesh,
    Model,
    Sphere,
    Visual,
)

Point = NDArray[np.float64]
#: Two wheels are a pair if their axes go along the line between them, give or take 45 degrees ...
_BESIDE: Final = 0.7
#: ... and opposite each other if they do by a sine below this [about 6 degrees].
_ALONG: Final = 0.1
#: The middle between the wheels may lie beside the robot's by this share of their distance.
_OFF_MIDDLE: Final = 0.1
#: What ends so much above the ground, as a share of a wheel's radius, touches it.
_ABOVE: Final = 0.1


class _Wheel(NamedTuple):
    """A link that turns without end: its middle and axis in the root's frame [m]."""

    link: Link
    middle: Point
    axis: Point
    radius: float


checks = Checks()


@checks()
@of_package
def wheels(facts: PackageFacts, tolerances: Tolerances) -> Finding:
    """It stands on two wheels that drive it, and on a caster.

    Two links turn on continuous joints about an axis from one to the other, left and right of the
    middle: otherwise 0. Half of the points each is lost where they are not opposite each other, as
    far from the middle and as large; where one of them has no collision; and where no other
    collision reaches down to the ground.
    """
    return best_of(facts, lambda robot, _: _driven(robot.model))


def _driven(model: Model | None) -> Finding:
    if model is None:
        return no_robot(msg("Not judged: there is no robot that could drive."))
    frames = kinematics.forward(model, {})
    found = list(_turning(model, frames))
    pairs = [each for each in combinations(found, 2) if _is_pair(*each)]
    if not pairs:
        rationale = msg(
            "No two wheels drive the robot: continuous joints turn {links}.",
            links=", ".join(shown(each.link.name) for each in found) or msg("nothing"),
        )
        help = msg(
            "It takes a wheel on each side, on a joint of the type continuous whose <axis> "
            "points from one wheel to the other."
        )
        return Finding(0, rationale, help)
    faults = min((list(_faults(model, frames, *each)) for each in pairs), key=len)
    if not faults:
        left, right = (shown(each.link.name) for each in pairs[0])
        return Finding(1, msg("{left} and {right} drive the robot.", left=left, right=right))
    return Finding(
        max(0.0, 1 - 0.5 * len(faults)),
        joined(faults, " "),
        msg("Place both wheels by the same numbers, and let wheels and caster end at one height."),
    )


def _turning(model: Model, frames: dict[str, kinematics.Transform]) -> Iterator[_Wheel]:
    """The links that continuous joints turn."""
    for joint in model.joints.values():
        frame, axis = frames.get(joint.child), np.array(joint.axis)
        if joint.type is not JointType.CONTINUOUS or frame is None or not axis.any():
            continue
        link = model.links[joint.child]
        shapes: list[Collision | Visual] = [*link.collisions, *link.visuals]
        shape = next((s for s in shapes if isinstance(s.geometry, Cylinder | Sphere)), None)
        place, radius = frame, 0.0
        if shape is not None and isinstance(shape.geometry, Cylinder | Sphere):
            place, radius = frame @ kinematics.matrix(shape.origin), shape.geometry.radius
        if shapes and np.isfinite(place).all():
            yield _Wheel(link, place[:3, 3], frame[:3, :3] @ axis / np.linalg.norm(axis), radius)


def _is_pair(one: _Wheel, other: _Wheel) -> bool:
    """Whether both turn about what goes from one to the other, in about."""
    line = _line(one, other)
    return all(abs(line @ each.axis) > _BESIDE for each in (one, other))


def _line(one: _Wheel, other: _Wheel) -> Point:
    """The direction from one to the other; 0 where both are in one place."""
    line = other.middle - one.middle
    length = np.linalg.norm(line)
    return line / length if length > 0 else line


def _faults(
    model: Model, frames: dict[str, kinematics.Transform], one: _Wheel, other: _Wheel
) -> Iterator[Message]:
    """What keeps a pair of wheels from driving the robot as it should."""
    line, names = _line(one, other), [shown(each.link.name) for each in (one, other)]
    apart = float(np.linalg.norm(other.middle - one.middle))
    beside = abs((one.middle + other.middle) / 2 @ line)
    is_along = all(np.linalg.norm(np.cross(line, each.axis)) < _ALONG for each in (one, other))
    is_round = np.isclose(one.radius, other.radius, rtol=0.02)
    if not is_along or beside > _OFF_MIDDLE * apart or not is_round:
        yield msg(
            "{left} and {right} are not opposite each other, as far from the middle and as large.",
            left=names[0],
            right=names[1],
        )
    bare = [each.link.name for each in (one, other) if not each.link.collisions]
    if bare:
        yield msg("{link} has no collision: it sinks into the ground.", link=shown(bare[0]))
    ground = min(_lowest(each.link, frames) for each in (one, other))
    others = (each for each in model.links.values() if each not in (one.link, other.link))
    if np.isfinite(ground) and all(
        _lowest(each, frames) > ground + _ABOVE * one.radius for each in others
    ):
        yield msg(
            "Beside {left} and {right} nothing stands on the ground.", left=names[0], right=names[1]
        )


def _lowest(link: Link, frames: dict[str, kinematics.Transform]) -> float:
    """How deep a link's collisions reach in the root's frame [m]; a mesh as deep as need be."""
    if link.name not in frames:
        return np.inf
    return min((_bottom(each, frames[link.name]) for each in link.collisions), default=np.inf)


def _bottom(shape: Collision, frame: kinematics.Transform) -> float:
    place = frame @ kinematics.matrix(shape.origin)
    down, kind = place[2, :3], shape.geometry
    if isinstance(kind, Mesh):
        return -np.inf
    if isinstance(kind, Sphere):
        reach = kind.radius
    elif isinstance(kind, Box):
        reach = float(np.abs(down) @ kind.size) / 2
    else:
        across = np.sqrt(max(0.0, 1 - down[2] ** 2))
        reach = kind.radius * across + abs(down[2]) * kind.length / 2
    return float(place[2, 3] - reach)
