"""A recorded run for a page: the robot, its way from above, its joints over time, and tf.

Every link is where tf says that it is, in `odom`. What no transform leads to stands at the origin,
white, as RViz shows it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from PIL import Image, ImageDraw

from grader.recording import Pixels
from grader.scenes.view import (
    Curve,
    Floats,
    PenChange,
    Placing,
    Plane,
    Solid,
    SolidFrame,
    Track,
    View,
)
from grader.text import Message, msg, place
from grader_robots.robot_py.model import Model
from grader_robots.scene import shapes
from grader_robots.scene.motion import (
    ODOM,
    Hung,
    JointMotion,
    Odometry,
    below,
    fitted,
    hung,
    joints,
    odometry,
    tree,
)
from grader_robots.scene.shapes import is_finite, name_of, named, transform
from grader_robots.scene.trace import TICK_NS, RobotTrace, Transform

#: Ten metres square, the origin of `odom` in the middle.
PLANE = Plane(size_px=500, metre_px=50.0, size_m=10.0, origin_m=-5.0)
BACKGROUND, GRID, AXES, INK, FITTED = "#f4f6f8", "#e0e5ea", "#aab4be", "#1f6feb", "#8a6d3b"
#: Curves of the robot as a whole, by their titles.
HEIGHT, HEADING = msg("Height above odom"), msg("Heading")
FROM_CENTRE = msg("Distance from its circle's centre")
FROM_ORIGIN = msg("Distance from the origin of odom")
#: So many joints have a plot; a submission can name any number.
MOST_JOINTS = 8
#: Beyond this there is nothing to be seen [m, rad].
FARTHEST = 1e6
_INK_PX = 3
#: A larger circle is a line, as far as it is in the picture.
_LARGEST_CIRCLE_M = 50.0
#: So often it is placed at most, however long the run.
SAMPLES = 150
#: Frames between odom and the links; a submission can send any number.
_MOST_FRAMES = 400
#: Of a way, what is this far from its end is not in the picture [m].
_NEAR_M = 15.0
_MOST_POINTS = 200


def view(trace: RobotTrace) -> View:
    """Everything that a page shows of a run."""
    way = odometry(trace)
    known = trace.robot.tree.moving if trace.robot else {}
    shown = sorted(joints(trace).values(), key=lambda joint: (joint.name not in known, joint.name))
    units = {name: "m" if joint.type == "prismatic" else "rad" for name, joint in known.items()}
    return View(
        tracks=() if not len(way) else (_track(trace, way),),
        step_ns=TICK_NS,
        background=BACKGROUND,
        curves=(
            *(_curve(joint, units.get(joint.name, "?")) for joint in shown[:MOST_JOINTS]),
            *_of_way(way, circle(trace)),
        ),
        drawn=tuple(_words(trace, way)),
        parts=tuple(part for part in (solid(trace), tree(trace)) if part is not None),
    )


def plan(trace: RobotTrace) -> Pixels:
    """The way from above, and the circle nearest to it, uint8 (500, 500, 3)."""
    image = Image.new("RGB", (PLANE.size_px, PLANE.size_px), BACKGROUND)
    draw = ImageDraw.Draw(image)
    for metre in range(int(PLANE.size_m) + 1):
        at = metre * PLANE.metre_px
        colour = AXES if metre + PLANE.origin_m == 0 else GRID
        draw.line((at, 0, at, PLANE.size_px), colour)
        draw.line((0, at, PLANE.size_px, at), colour)
    _draw_circle(draw, circle(trace))
    way = odometry(trace)
    points = np.column_stack(_pixels(way))
    is_there = np.isfinite(points).all(axis=1)
    for piece in np.split(points, np.flatnonzero(~is_there)):
        piece = piece[np.isfinite(piece).all(axis=1)]
        if len(piece) > 1:
            draw.line([tuple(each) for each in piece.tolist()], INK, _INK_PX, joint="curve")
    return np.asarray(image)


def _draw_circle(draw: ImageDraw.ImageDraw, circle: tuple[float, float, float] | None) -> None:
    if circle is None or max(map(abs, circle)) > _LARGEST_CIRCLE_M:
        return
    x, y = PLANE.to_px(*circle[:2])
    far = circle[2] * PLANE.metre_px
    draw.ellipse((x - far, y - far, x + far, y + far), outline=FITTED)
    draw.line((x - 4, y, x + 4, y), FITTED)
    draw.line((x, y - 4, x, y + 4), FITTED)


def _pixels(way: Odometry) -> tuple[Floats, Floats]:
    """The places of a way in the picture [px, y down]; not a number far outside."""
    places = way.places[:, :2].copy()
    places[~(np.abs(places) < FARTHEST).all(axis=1)] = np.nan
    return (
        (places[:, 0] - PLANE.origin_m) * PLANE.metre_px,
        (PLANE.end_m - places[:, 1]) * PLANE.metre_px,
    )


def _track(trace: RobotTrace, way: Odometry) -> Track:
    """At each tick where it was told last."""
    name = trace.robot.model.root if trace.robot else ""
    ticks = np.arange(way.ticks[0], trace.ticks + 1, dtype=np.int64)
    last = np.searchsorted(way.ticks, ticks, side="right") - 1
    x, y = _pixels(way)
    return Track(
        name, ticks * TICK_NS, x[last], y[last], way.yaw[last], (PenChange(0, INK, _INK_PX),)
    )


def _curve(joint: JointMotion, unit: str) -> Curve:
    return Curve(curve_of(joint.name), unit, joint.ticks * TICK_NS, _drawable(joint.positions))


def curve_of(joint: str) -> Message:
    """The title of a joint's curve."""
    return msg("Joint {name}", name=name_of(joint))


def _of_way(way: Odometry, circle: tuple[float, float, float] | None) -> tuple[Curve, ...]:
    if not len(way):
        return ()
    times_ns = way.ticks * TICK_NS
    with np.errstate(all="ignore"):
        x, y, _ = circle or (0.0, 0.0, 0.0)
        distance = np.hypot(way.places[:, 0] - x, way.places[:, 1] - y)
    return (
        Curve(FROM_CENTRE if circle else FROM_ORIGIN, "m", times_ns, _drawable(distance)),
        Curve(HEIGHT, "m", times_ns, _drawable(way.places[:, 2])),
        Curve(HEADING, "rad", times_ns, _drawable(way.yaw)),
    )


def _drawable(values: Floats) -> Floats:
    return np.where(np.abs(values) < FARTHEST, values, np.nan)


def _words(trace: RobotTrace, way: Odometry) -> Iterator[Message]:
    if trace.robot is None:
        yield msg("no robot description was recorded")
    there = way.places[np.isfinite(way.places).all(axis=1)]
    if not len(there):
        yield msg("nothing: no transform from odom to the robot's root was heard")
        return
    first, last = (place(float(row[0]), float(row[1])) for row in (there[0], there[-1]))
    yield msg("the robot's way in odom, from {first} to {last}", first=first, last=last)
    if (round_ := circle(trace)) is not None:
        yield msg(
            "the circle nearest to it: {radius:.2f} m around {centre}",
            radius=round_[2],
            centre=place(*round_[:2]),
        )


# The robot ------------------------------------------------------------------------------------


def solid(trace: RobotTrace) -> Solid | None:
    """The robot over time; None where no description was recorded."""
    robot = trace.robot
    if robot is None:
        return None
    heard = hung(trace)
    ticks = sample_ticks(trace.ticks)
    names = below(ODOM, heard)[:_MOST_FRAMES]
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
    lost = tuple(link for link in robot.model.links if link not in places(trace))
    notes = _notes(trace, robot.model, lost)
    times_ns = tuple(tick * TICK_NS for tick in ticks)
    return shapes.solid(
        robot.model, frames, numbers, lost, notes, times_ns=times_ns, way=way(trace)
    )


def places(trace: RobotTrace) -> dict[str, Floats]:
    """Of each link that has a place in odom at the end: where that is, 4 x 4."""
    heard = hung(trace)
    frames = {ODOM: np.eye(4)}
    for name in below(ODOM, heard):
        last = heard[name].transforms[-1]
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


def _notes(trace: RobotTrace, model: Model, lost: tuple[str, ...]) -> Iterator[Message]:
    """What there is to see, for who cannot."""
    if (root := places(trace).get(model.root)) is not None:
        yield msg(
            "at {place} in {odom} at the end",
            place=place(float(root[0, 3]), float(root[1, 3])),
            odom=ODOM,
        )
    if (round_ := circle(trace)) is not None:
        yield msg("its way lies about a circle of {radius:.2f} m", radius=round_[2])
    if lost:
        yield msg("white, at the origin, for want of a transform: {names}", names=named(lost))


def sample_ticks(ticks: int) -> tuple[int, ...]:
    """Evenly, the last one among them."""
    step = max(1, -(-ticks // SAMPLES))
    return tuple(range(ticks % step or step, ticks + 1, step)) if ticks else ()


def _placings(frame: Hung, ticks: tuple[int, ...]) -> tuple[Placing | None, ...]:
    """Where it was said to be at each tick, last; what is static always was there."""
    if frame.is_static or not ticks:
        return (_placing(frame.transforms[-1]),)
    at = np.searchsorted([each.tick for each in frame.transforms], ticks, side="right") - 1
    each = tuple(None if row < 0 else _placing(frame.transforms[row]) for row in at.tolist())
    return each[:1] if len(set(each)) == 1 else each


def _placing(notes: Transform) -> Placing | None:
    if not is_finite(notes.translation):
        return None
    length = math.sqrt(sum(value * value for value in notes.rotation))
    if not 0 < length < math.inf:
        return None
    x, y, z, w = (value / length for value in notes.rotation)
    return Placing(notes.translation, (x, y, z, w))
