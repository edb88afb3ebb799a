"""A recorded run for a page: the robot, its way from above, its joints over time, and tf."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageDraw

from grader import text
from grader.language.phrase import say
from grader.scenes.robot import frames, solid
from grader.scenes.robot.motion import Floats, Joint, Way, joints, odometry
from grader.scenes.robot.trace import RobotTrace
from grader.scenes.robot_parts import name_of
from grader.scenes.view import Curve, PenChange, Pixels, Plane, Track, View

#: Ten metres square, the origin of `odom` in the middle.
PLANE = Plane(size_px=500, metre_px=50.0, size_m=10.0, origin_m=-5.0)
BACKGROUND, GRID, AXES, INK, FITTED = "#f4f6f8", "#e0e5ea", "#aab4be", "#1f6feb", "#8a6d3b"
#: Curves of the robot as a whole, by their titles.
HEIGHT, HEADING = say("Height above odom"), say("Heading")
FROM_CENTRE = say("Distance from its circle's centre")
FROM_ORIGIN = say("Distance from the origin of odom")
#: So many joints have a plot; a submission can name any number.
MOST_JOINTS = 8
#: Beyond this there is nothing to be seen [m, rad].
FARTHEST = 1e6
_INK_PX = 3
#: A larger circle is a line, as far as it is in the picture.
_LARGEST_CIRCLE_M = 50.0


def view(trace: RobotTrace) -> View:
    """Everything that a page shows of a run."""
    way = odometry(trace)
    known = trace.robot.tree.moving if trace.robot else {}
    shown = sorted(joints(trace).values(), key=lambda joint: (joint.name not in known, joint.name))
    units = {name: "m" if joint.type == "prismatic" else "rad" for name, joint in known.items()}
    return View(
        tracks=() if not len(way) else (_track(trace, way),),
        cleared=(),
        background=BACKGROUND,
        rest=None,
        curves=(
            *(_curve(joint, units.get(joint.name, "?")) for joint in shown[:MOST_JOINTS]),
            *_of_way(way, solid.circle(trace)),
        ),
        calls=(),
        drawn=_words(trace, way),
        parts=tuple(part for part in (solid.solid(trace), frames.tree(trace)) if part is not None),
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
    _draw_circle(draw, solid.circle(trace))
    way = odometry(trace)
    x, y = _pixels(way)
    for piece in _finite_pieces(np.column_stack((x, y))):
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


def _pixels(way: Way) -> tuple[Floats, Floats]:
    """The places of a way in the picture [px, y down]; not a number far outside."""
    places = way.places[:, :2].copy()
    places[~(np.abs(places) < FARTHEST).all(axis=1)] = np.nan
    return (
        (places[:, 0] - PLANE.origin_m) * PLANE.metre_px,
        (PLANE.end_m - places[:, 1]) * PLANE.metre_px,
    )


def _finite_pieces(points: Floats) -> list[Floats]:
    lost = np.flatnonzero(~np.isfinite(points).all(axis=1))
    pieces = np.split(points, lost)
    return [piece[np.isfinite(piece).all(axis=1)] for piece in pieces]


def _track(trace: RobotTrace, way: Way) -> Track:
    """At each tick where it was told last."""
    name = trace.robot.model.root if trace.robot else ""
    ticks = np.arange(way.ticks[0], trace.ticks + 1, dtype=np.int64)
    last = np.searchsorted(way.ticks, ticks, side="right") - 1
    x, y = _pixels(way)
    return Track(name, ticks, x[last], y[last], way.yaw[last], (PenChange(0, INK, _INK_PX),))


def _curve(joint: Joint, unit: str) -> Curve:
    return Curve(
        curve_of(joint.name), unit, joint.ticks.astype(np.float64), _drawable(joint.positions)
    )


def curve_of(joint: str) -> str:
    """The title of a joint's curve."""
    return say("Joint {name}", name=name_of(joint))


def _of_way(way: Way, circle: tuple[float, float, float] | None) -> tuple[Curve, ...]:
    if not len(way):
        return ()
    ticks = way.ticks.astype(np.float64)
    with np.errstate(all="ignore"):
        x, y, _ = circle or (0.0, 0.0, 0.0)
        distance = np.hypot(way.places[:, 0] - x, way.places[:, 1] - y)
    return (
        Curve(FROM_CENTRE if circle else FROM_ORIGIN, "m", ticks, _drawable(distance)),
        Curve(HEIGHT, "m", ticks, _drawable(way.places[:, 2])),
        Curve(HEADING, "rad", ticks, _drawable(way.yaw)),
    )


def _drawable(values: Floats) -> Floats:
    return np.where(np.abs(values) < FARTHEST, values, np.nan)


def _words(trace: RobotTrace, way: Way) -> tuple[str, ...]:
    there = way.places[np.isfinite(way.places).all(axis=1)]
    if not len(there):
        return (say("nothing: no transform from odom to the robot's root was heard"),)
    first, last = (text.place(float(row[0]), float(row[1])) for row in (there[0], there[-1]))
    told: list[str] = [
        say("the robot's way in odom, from {first} to {last}", first=first, last=last)
    ]
    if (round_ := solid.circle(trace)) is not None:
        centre = text.place(*round_[:2])
        told.append(
            say(
                "the circle nearest to it: {radius:.2f} m around {centre}",
                radius=round_[2],
                centre=centre,
            )
        )
    return tuple(told)
