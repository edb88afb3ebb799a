"""The robot as it stood and moved: every link where tf says that it is, in `odom`.

What no transform leads to stands at the origin, white, as RViz shows it.
"""

from __future__ import annotations

import math

import numpy as np

from grader import text
from grader.language.phrase import joined, say, say_many
from grader.scenes.robot.decoding import Transform
from grader.scenes.robot.frames import Hung, below, hung
from grader.scenes.robot.motion import ODOM, Floats, fitted, odometry
from grader.scenes.robot.trace import RobotTrace
from grader.scenes.robot_parts import (
    is_finite,
    name_of,
    named,
    place_less,
    shapes,
    transform,
)
from grader.scenes.view import Pixels, Placing, Solid, SolidFrame
from robot_py.drawing import NOBODY, body, picture

#: So often it is placed at most, however long the run.
SAMPLES = 150
#: Frames between odom and the links; a submission can send any number.
_MOST_FRAMES = 400
#: Of a way, what is this far from its end is not in the picture [m].
_NEAR_M = 15.0
_MOST_POINTS = 200


def solid(trace: RobotTrace) -> Solid | None:
    """The robot over time; None where no description was recorded."""
    robot = trace.robot
    if robot is None:
        return None
    heard = hung(trace)
    ticks = sample_ticks(trace.ticks)
    names = [*dict.fromkeys((*below(ODOM, heard)[:_MOST_FRAMES],))]
    numbers = {name: number for number, name in enumerate(names)}
    frames = [
        SolidFrame(name_of(n), numbers.get(heard[n].parent, -1), _placings(heard[n], ticks))
        for n in names
    ]
    for link in robot.model.links:
        if link not in numbers:
            # odom itself may be a link: it is where the ground is
            numbers[link] = len(frames)
            placings = (Placing(),) if link == ODOM else (None,)
            frames.append(SolidFrame(name_of(link), -1, placings))
    made, left_out = shapes(robot.model, numbers, {})
    lost = tuple(link for link in robot.model.links if link not in places(trace))
    return Solid(
        say("The robot {name}", name=name_of(robot.model.name)),
        words(trace, lost, left_out),
        tuple(frames),
        made,
        ticks,
        0.0,
        way(trace),
        tuple(map(name_of, lost)),
        left_out,
    )


def window(trace: RobotTrace) -> Pixels:
    """The robot as it stood at the end, with its way on the ground, uint8 (500, 500, 3)."""
    if trace.robot is None:
        return picture(NOBODY, labels=(say("no robot description was recorded"),))
    there = body(trace.robot.model, places(trace))
    line = way(trace)
    lost = [*place_less(there.lost)]
    return picture(there, ways=(line,) if len(line) else (), labels=lost)


def places(trace: RobotTrace) -> dict[str, Floats]:
    """Of each link that has a place in odom at the end: where that is, 4 x 4."""
    heard = hung(trace)
    frames = {ODOM: np.eye(4)}
    for name in below(ODOM, heard):
        last = heard[name].said[-1]
        with np.errstate(all="ignore"):
            frames[name] = frames[heard[name].parent] @ transform(last.translation, last.rotation)
    links = trace.robot.model.links if trace.robot else {}
    return {
        link: frames[link]
        for link in links
        if link in frames and is_finite(frames[link].ravel().tolist())
    }


def way(trace: RobotTrace) -> Floats:
    """Where the robot went, float64 (n, 2) [m]: what of it is near its end."""
    points = odometry(trace).places[:, :2]
    points = points[np.isfinite(points).all(axis=1)]
    if not len(points):
        return points
    points = points[(np.abs(points - points[-1]) < _NEAR_M).all(axis=1)]
    step = max(1, -(-len(points) // _MOST_POINTS))
    return np.concatenate((points[:-1:step], points[-1:]))


def circle(trace: RobotTrace) -> tuple[float, float, float] | None:
    """The circle nearest to the way: x, y, radius [m]; None where there is none."""
    points = odometry(trace).places[:, :2]
    points = points[(np.abs(points) < 1e6).all(axis=1)]
    if len(points) < 3:
        return None
    x, y, radius, _ = fitted(points)
    return (x, y, radius) if math.isfinite(radius) and radius < 1e3 else None


def words(trace: RobotTrace, lost: tuple[str, ...], left_out: tuple[str, ...]) -> str:
    """What there is to see, for who cannot."""
    robot = trace.robot
    if robot is None:
        return say("no robot description was recorded")
    said = [
        say_many(
            "The robot {name} with {n:,} link",
            "The robot {name} with {n:,} links",
            len(robot.model.links),
            name=name_of(robot.model.name),
        )
    ]
    root = places(trace).get(robot.model.root)
    if root is not None:
        said.append(
            say(
                "at {place} in {odom} at the end",
                place=text.place(float(root[0, 3]), float(root[1, 3])),
                odom=ODOM,
            )
        )
    if (round_ := circle(trace)) is not None:
        said.append(say("its way lies about a circle of {radius:.2f} m", radius=round_[2]))
    if lost:
        said.append(
            say("white, at the origin, for want of a transform: {names}", names=named(lost))
        )
    if left_out:
        said.append(say("not drawn: {names}", names=named(left_out)))
    return joined(said, say("; "))


def sample_ticks(ticks: int) -> tuple[int, ...]:
    """Evenly, the last one among them."""
    step = max(1, -(-ticks // SAMPLES))
    return tuple(range(ticks % step or step, ticks + 1, step)) if ticks else ()


def _placings(frame: Hung, ticks: tuple[int, ...]) -> tuple[Placing | None, ...]:
    """Where it was said to be at each tick, last; what is static always was there."""
    if frame.is_static or not ticks:
        return (_placing(frame.said[-1]),)
    at = np.searchsorted([each.tick for each in frame.said], ticks, side="right") - 1
    each = tuple(None if row < 0 else _placing(frame.said[row]) for row in at.tolist())
    return each[:1] if len(set(each)) == 1 else each


def _placing(said: Transform) -> Placing | None:
    if not is_finite(said.translation):
        return None
    length = math.sqrt(sum(value * value for value in said.rotation))
    if not 0 < length < math.inf:
        return None
    x, y, z, w = (value / length for value in said.rotation)
    return Placing(said.translation, (x, y, z, w))
