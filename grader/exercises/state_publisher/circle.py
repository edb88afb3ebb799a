"""Whether the robot goes in a circle: round, at one height, upright, looking where it goes."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Evidence, Expected, Finding
from grader.exercises.state_publisher.seen import Seen, sentence
from grader.language.phrase import say, say_many
from grader.scenes.robot.motion import ODOM, Floats, Way, bare, fitted
from grader.scenes.robot.view import FROM_CENTRE
from grader.scenes.robot.view import HEADING as HEADING_CURVE
from grader.scenes.robot.view import HEIGHT as HEIGHT_CURVE

#: What each is worth: the circle, its height, the heading, the quaternion.
CIRCLE, HEIGHT, HEADING, QUATERNION = 0.35, 0.15, 0.3, 0.2
#: The square of a quaternion's length may be off 1 by this.
DENORMALIZED = 0.01


class Fault(NamedTuple):
    """What is wrong, what it costs, and what to look at."""

    text: str
    costs: float
    help: str


def judge_odometry(seen: Seen, tolerances: Tolerances) -> Finding:
    """All transforms from odom to the root."""
    way = seen.way
    if len(way) < tolerances["least_messages"]:
        return _absent(seen)
    if not (np.abs(way.places) < 1e6).all() or not np.isfinite(way.quaternions).all():
        return Finding(
            0,
            say(
                "A transform from {parent} to {child} holds what is no number.",
                parent=ODOM,
                child=seen.root,
            ),
            say("Which of your terms can become nan or inf?"),
            (seen.moment(int(way.ticks[0]), say("no number")),),
        )
    faults = [*_circle(way, tolerances), *_height(way, tolerances), *_turned(way, tolerances)]
    wanted = _wanted(tolerances)
    if faults:
        where: tuple[Evidence, ...] = (seen.moment(int(way.ticks[-1]), faults[0].text),)
        share = 1 - sum(fault.costs for fault in faults)
        return Finding(
            max(share, 0.0),
            sentence([fault.text for fault in faults]),
            say("{help} Look at the transform that you send on /tf.", help=faults[0].help),
            where,
            expected=wanted,
        )
    _, _, radius, _ = fitted(way.places[:, :2])
    height = float(np.median(way.places[:, 2]))
    return Finding(
        1,
        say(
            "{root} goes in a circle of {radius:.2f} m at a height of {height:.2f} "
            "m, upright and looking where it goes.",
            root=seen.root,
            radius=radius,
            height=height,
        ),
        expected=wanted,
    )


def _wanted(tolerances: Tolerances) -> tuple[Expected, ...]:
    """For the plots of the robot as a whole."""
    radius = tolerances["radius_least_m"], tolerances["radius_most_m"]
    height = tolerances["height_least_m"], tolerances["height_most_m"]
    return (
        Expected(
            FROM_CENTRE,
            say("constant, {least:g} to {most:g} m", least=radius[0], most=radius[1]),
            radius,
        ),
        Expected(
            HEIGHT_CURVE,
            say("constant, {least:g} to {most:g} m", least=height[0], most=height[1]),
            height,
        ),
        Expected(HEADING_CURVE, say("where it goes: it turns on as the robot goes round")),
    )


def _absent(seen: Seen) -> Finding:
    way = seen.way
    ends = {"parent": ODOM, "child": seen.root}
    others = list(dict.fromkeys((t.topic, bare(t.parent), bare(t.child)) for t in seen.sent))
    if ("/tf", seen.root, ODOM) in others:
        told = say(
            "Your transform on /tf goes from {child!r} to {parent!r}: the frames are swapped.",
            **ends,
        )
        help = say(
            "The parent, {parent!r}, stands in header.frame_id; the child in child_frame_id.",
            parent=ODOM,
        )
    elif any(each == ("/tf_static", ODOM, seen.root) for each in others):
        told = say(
            "The transform from {parent!r} to {child!r} came on /tf_static, and what is static "
            "never moves.",
            **ends,
        )
        help = say("Send what moves by a TransformBroadcaster: it goes to /tf.")
    elif others and not len(way):
        _, parent, child = others[0]
        told = say(
            "No transform from {parent!r} to {child!r} came on /tf, but one from {from_} to {to}.",
            **ends,
            from_=f"{parent!r:.40}",
            to=f"{child!r:.40}",
        )
        help = say(
            "The robot stands in the world by {odom!r} and the root link of its URDF.", odom=ODOM
        )
    elif ("/tf", ODOM, seen.root) in others:
        told = say_many(
            "Only {n} transform from {parent!r} to {child!r} came on /tf: too few to see a way.",
            "Only {n} transforms from {parent!r} to {child!r} came on /tf: too few to see a way.",
            len(way),
            **ends,
        )
        help = say("Does your node go on to send its TransformStamped, time after time?")
    else:
        told = say("No transform from {parent!r} to {child!r} came on /tf.", **ends)
        help = say("Does your node send its TransformStamped each time, by a TransformBroadcaster?")
    return Finding(0, told, help)


def _circle(way: Way, tolerances: Tolerances) -> list[Fault]:
    points = way.places[:, :2]
    x, y, radius, off = fitted(points)
    low, high = tolerances["radius_least_m"], tolerances["radius_most_m"]
    help = say(
        "x and y are the radius times the cosine and the sine of one angle that grows steadily."
    )
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if float(steps.sum()) < tolerances["way_least_m"]:
        text = say("the robot stays where it is, at {place}", place=_place(points[0]))
        return [Fault(text, CIRCLE + HEADING, help)]
    if not math.isfinite(radius) or off > tolerances["round_share"] * radius:
        return [Fault(say("its way is no circle"), CIRCLE, help)]
    if not low <= radius <= high:
        text = say(
            "its circle has a radius of {radius:.3g} m; expected {low} to {high} m",
            radius=radius,
            low=low,
            high=high,
        )
        return [Fault(text, CIRCLE, say("Lengths are in metres."))]
    angles = np.unwrap(np.arctan2(points[:, 1] - y, points[:, 0] - x))
    turns = np.diff(angles)
    turns = turns[np.abs(turns) > 1e-9]
    one_way = max((turns > 0).mean(), (turns < 0).mean()) if len(turns) else 0.0
    if one_way < tolerances["one_way"]:
        return [Fault(say("it goes to and fro on its circle"), CIRCLE, help)]
    if float(np.quantile(steps, 0.99)) > 6 * float(np.median(steps)) + 0.01:
        return [Fault(say("it jumps along its circle"), CIRCLE, help)]
    return []


def _height(way: Way, tolerances: Tolerances) -> list[Fault]:
    heights = way.places[:, 2]
    low, high = tolerances["height_least_m"], tolerances["height_most_m"]
    height = float(np.median(heights))
    if float(np.ptp(heights)) > tolerances["height_error_m"]:
        text = say(
            "its height changes, from {least:.2f} to {most:.2f} m",
            least=heights.min(),
            most=heights.max(),
        )
        return [Fault(text, HEIGHT, say("A robot that walks on level ground keeps its height."))]
    if not low <= height <= high:
        return [
            Fault(
                say(
                    "its height is {height:.3g} m; expected {low} to {high} m",
                    height=height,
                    low=low,
                    high=high,
                ),
                HEIGHT,
                say("The legs reach below the root link: how high must that be for them to stand?"),
            )
        ]
    return []


def _turned(way: Way, tolerances: Tolerances) -> list[Fault]:
    x, y, z, w = way.quaternions.T
    squares = x * x + y * y + z * z + w * w
    faults = []
    if not squares.all():
        text = say("its quaternion is all zeros, which turns nothing")
        help = say(
            "Straight ahead is w = 1.0; a turn about z is z = sin(angle / 2), w = cos(angle / 2)."
        )
        return [Fault(text, QUATERNION + HEADING, help)]
    if float(np.abs(squares - 1).max()) >= DENORMALIZED:
        worst = float(np.sqrt(squares[int(np.argmax(np.abs(squares - 1)))]))
        faults.append(
            Fault(
                say("its quaternion has the length {length:.3g} instead of 1", length=worst),
                QUATERNION,
                say("A turn by an angle about z is z = sin(angle / 2), w = cos(angle / 2)."),
            )
        )
    with np.errstate(all="ignore"):
        upright = np.degrees(np.arccos(np.clip((w * w - x * x - y * y + z * z) / squares, -1, 1)))
    if not float(np.quantile(upright, 0.95)) <= tolerances["upright_deg"]:
        text = say(
            "it does not stand upright, but leans by {angle:.0f} degrees",
            angle=np.median(upright),
        )
        order = say(
            "A Quaternion has the order x, y, z, w: is yours w first, or turned about x or y?"
        )
        cost = 0.0 if faults else QUATERNION
        return [*faults, Fault(text, cost + HEADING, order)]
    off = heading_error(way)
    if off is not None and abs(off) > tolerances["heading_deg"]:
        faults.append(
            Fault(
                say(
                    "it looks {angle:.0f} degrees beside the direction in which it goes",
                    angle=abs(off),
                ),
                HEADING,
                _why_beside(off, is_steady=_is_steady(heading_errors(way))),
            )
        )
    return faults


def _is_steady(off: Floats) -> bool:
    """Whether angles are nearly the same [rad]."""
    return bool(abs(np.exp(1j * off).mean()) > 0.9)


def _why_beside(off: float, *, is_steady: bool) -> str:
    """What it may be that one looks so many degrees beside one's direction, all the way or not."""
    if is_steady and abs(abs(off) - 180) < 20:
        return say("It goes backwards: turn its heading by pi, or go round the other way.")
    if is_steady and abs(abs(off) - 90) < 20:
        return say(
            "It looks along the radius, and on a circle one goes at a right angle "
            "to that: the heading is the angle on the circle plus pi / 2, or minus "
            "where one goes clockwise."
        )
    return say(
        "Its heading has to grow as the angle on the circle does, in radians, a"
        " quarter turn ahead of that; half of it stands in a quaternion: z = "
        "sin(heading / 2), w = cos(heading / 2)."
    )


def heading_error(way: Way) -> float | None:
    """By how much it usually looks beside its direction [degrees]; None where it does not move."""
    off = heading_errors(way)
    if not len(off):
        return None
    return math.degrees(float(off[int(np.argsort(np.abs(off))[int(0.9 * (len(off) - 1))])]))


def heading_errors(way: Way) -> Floats:
    """By how much it looks beside its direction, wherever it moves [rad], -pi to pi."""
    points, yaw = way.places[:, :2], way.yaw
    steps = points[2:] - points[:-2]  # about the point between
    moves = np.linalg.norm(steps, axis=1) > 1e-6
    goes = np.arctan2(steps[moves, 1], steps[moves, 0])
    off: Floats = (yaw[1:-1][moves] - goes + math.pi) % (2 * math.pi) - math.pi
    return off


def _place(point: Floats) -> str:
    return say("({x:.2f}, {y:.2f})", x=point[0], y=point[1])
