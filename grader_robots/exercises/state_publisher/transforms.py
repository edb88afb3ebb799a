"""Transforms: whether the robot goes in a circle, upright, and every link hangs below `odom`.

The circle is round, at one height, and the robot looks where it goes.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from grader import Checks, Expected, Finding, Tolerances
from grader.scenes.view import Floats
from grader.text import Message, msg, place
from grader_robots.exercises.state_publisher.seen import RobotRun, listed, of_run, sentence
from grader_robots.scene.motion import ODOM, Odometry, bare, below, fitted, hung, why_refused
from grader_robots.scene.view import FROM_CENTRE
from grader_robots.scene.view import HEADING as HEADING_CURVE
from grader_robots.scene.view import HEIGHT as HEIGHT_CURVE

checks = Checks()
#: What each is worth: the circle, its height, the heading, the quaternion.
CIRCLE, HEIGHT, HEADING, QUATERNION = 0.35, 0.15, 0.3, 0.2
#: The square of a quaternion's length may be off 1 by this.
DENORMALIZED = 0.01
_ONE_TRANSFORM = msg(
    "robot_state_publisher sends what lies inside of the robot, from your joint states; your node "
    "sends one transform, from {odom!r} to the root link, and no other.",
    odom=ODOM,
)
_EACH_TIME = msg("Does your node send its TransformStamped each time, by a TransformBroadcaster?")


class WayFault(NamedTuple):
    """What is wrong, what it costs, and what to look at."""

    text: Message
    costs: float
    help: Message


@checks()
@of_run
def odometry(seen: RobotRun, tolerances: Tolerances) -> Finding:
    """The robot goes in a circle and looks ahead.

    The transforms from `odom` to the root link lie on a circle with a radius of {radius_least_m} to
    {radius_most_m} m, in either direction, and go one way without jumps (35 % of the points); at a
    constant height of {height_least_m} to {height_most_m} m (15 %); the robot stands upright and
    looks in the direction in which it goes, give or take {heading_deg} degrees (30 %); and the
    quaternion has the length 1 (20 %).
    """
    way = seen.way
    if len(way) < tolerances["least_messages"]:
        return _absent(seen)
    if not (np.abs(way.places) < 1e6).all() or not np.isfinite(way.quaternions).all():
        rationale = msg(
            "A transform from {parent} to {child} holds what is no number.",
            parent=ODOM,
            child=seen.root,
        )
        help = msg("Which of your terms can become nan or inf?")
        return Finding(0, rationale, help, (seen.moment(int(way.ticks[0]), msg("no number")),))
    faults = [*_circle(way, tolerances), *_height(way, tolerances), *_turned(way, tolerances)]
    wanted = _wanted(tolerances)
    if faults:
        share = 1 - sum(fault.costs for fault in faults)
        return Finding(
            max(share, 0.0),
            sentence([fault.text for fault in faults]),
            msg("{help} Look at the transform that you send on /tf.", help=faults[0].help),
            (seen.moment(int(way.ticks[-1]), faults[0].text),),
            expected=wanted,
        )
    _, _, radius, _ = fitted(way.places[:, :2])
    height = float(np.median(way.places[:, 2]))
    said = msg(
        "{root} goes in a circle of {radius:.2f} m at a height of {height:.2f} "
        "m, upright and looking where it goes."
    )
    said = said.given(root=seen.root, radius=radius, height=height)
    return Finding(1, said, expected=wanted)


def _wanted(tolerances: Tolerances) -> tuple[Expected, ...]:
    """For the plots of the robot as a whole."""
    radius = tolerances["radius_least_m"], tolerances["radius_most_m"]
    height = tolerances["height_least_m"], tolerances["height_most_m"]
    constant = (
        Expected(curve, msg("constant, {least:g} to {most:g} m", least=span[0], most=span[1]), span)
        for curve, span in ((FROM_CENTRE, radius), (HEIGHT_CURVE, height))
    )
    heading = msg("where it goes: it turns on as the robot goes round")
    return (*constant, Expected(HEADING_CURVE, heading))


def _absent(seen: RobotRun) -> Finding:
    way = seen.way
    ends = {"parent": ODOM, "child": seen.root}
    others = list(dict.fromkeys((t.topic, bare(t.parent), bare(t.child)) for t in seen.sent))
    if ("/tf", seen.root, ODOM) in others:
        rationale = msg(
            "Your transform on /tf goes from {child!r} to {parent!r}: the frames are swapped.",
            **ends,
        )
        help = msg(
            "The parent, {parent!r}, stands in header.frame_id; the child in child_frame_id.",
            parent=ODOM,
        )
    elif ("/tf_static", ODOM, seen.root) in others:
        rationale = msg(
            "The transform from {parent!r} to {child!r} came on /tf_static, and what is static "
            "never moves.",
            **ends,
        )
        help = msg("Send what moves by a TransformBroadcaster: it goes to /tf.")
    elif others and not len(way):
        _, parent, child = others[0]
        rationale = msg(
            "No transform from {parent!r} to {child!r} came on /tf, but one from {from_} to {to}.",
            **ends,
            from_=f"{parent!r:.40}",
            to=f"{child!r:.40}",
        )
        help = msg(
            "The robot stands in the world by {odom!r} and the root link of its URDF.", odom=ODOM
        )
    elif ("/tf", ODOM, seen.root) in others:
        rationale = msg(
            "Only {n} transform from {parent!r} to {child!r} came on /tf: too few to see a way.",
            "Only {n} transforms from {parent!r} to {child!r} came on /tf: too few to see a way.",
            n=len(way),
            **ends,
        )
        help = _EACH_TIME
    else:
        rationale = msg("No transform from {parent!r} to {child!r} came on /tf.", **ends)
        help = _EACH_TIME
    return Finding(0, rationale, help)


def _circle(way: Odometry, tolerances: Tolerances) -> list[WayFault]:
    points = way.places[:, :2]
    x, y, radius, off = fitted(points)
    low, high = tolerances["radius_least_m"], tolerances["radius_most_m"]
    help = msg(
        "x and y are the radius times the cosine and the sine of one angle that grows steadily."
    )
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    if float(steps.sum()) < tolerances["way_least_m"]:
        at = place(float(points[0, 0]), float(points[0, 1]))
        text = msg("the robot stays where it is, at {place}", place=at)
        return [WayFault(text, CIRCLE + HEADING, help)]
    if not math.isfinite(radius) or off > tolerances["round_share"] * radius:
        return [WayFault(msg("its way is no circle"), CIRCLE, help)]
    if not low <= radius <= high:
        text = msg(
            "its circle has a radius of {radius:.3g} m; expected {low} to {high} m",
            radius=radius,
            low=low,
            high=high,
        )
        return [WayFault(text, CIRCLE, msg("Lengths are in metres."))]
    angles = np.unwrap(np.arctan2(points[:, 1] - y, points[:, 0] - x))
    turns = np.diff(angles)
    turns = turns[np.abs(turns) > 1e-9]
    one_way = max((turns > 0).mean(), (turns < 0).mean()) if len(turns) else 0.0
    if one_way < tolerances["one_way"]:
        return [WayFault(msg("it goes to and fro on its circle"), CIRCLE, help)]
    if float(np.quantile(steps, 0.99)) > 6 * float(np.median(steps)) + 0.01:
        return [WayFault(msg("it jumps along its circle"), CIRCLE, help)]
    return []


def _height(way: Odometry, tolerances: Tolerances) -> list[WayFault]:
    heights = way.places[:, 2]
    low, high = tolerances["height_least_m"], tolerances["height_most_m"]
    height = float(np.median(heights))
    if float(np.ptp(heights)) > tolerances["height_error_m"]:
        text = msg(
            "its height changes, from {least:.2f} to {most:.2f} m",
            least=heights.min(),
            most=heights.max(),
        )
        return [WayFault(text, HEIGHT, msg("A robot that walks on level ground keeps its height."))]
    if not low <= height <= high:
        text = msg(
            "its height is {height:.3g} m; expected {low} to {high} m",
            height=height,
            low=low,
            high=high,
        )
        help = msg("The legs reach below the root link: how high must that be for them to stand?")
        return [WayFault(text, HEIGHT, help)]
    return []


def _turned(way: Odometry, tolerances: Tolerances) -> list[WayFault]:
    x, y, z, w = way.quaternions.T
    squares = x * x + y * y + z * z + w * w
    faults = []
    if not squares.all():
        text = msg("its quaternion is all zeros, which turns nothing")
        help = msg(
            "Straight ahead is w = 1.0; a turn about z is z = sin(angle / 2), w = cos(angle / 2)."
        )
        return [WayFault(text, QUATERNION + HEADING, help)]
    if float(np.abs(squares - 1).max()) >= DENORMALIZED:
        worst = float(np.sqrt(squares[int(np.argmax(np.abs(squares - 1)))]))
        text = msg("its quaternion has the length {length:.3g} instead of 1", length=worst)
        help = msg("A turn by an angle about z is z = sin(angle / 2), w = cos(angle / 2).")
        faults.append(WayFault(text, QUATERNION, help))
    with np.errstate(all="ignore"):
        upright = np.degrees(np.arccos(np.clip((w * w - x * x - y * y + z * z) / squares, -1, 1)))
    if not float(np.quantile(upright, 0.95)) <= tolerances["upright_deg"]:
        text = msg(
            "it does not stand upright, but leans by {angle:.0f} degrees", angle=np.median(upright)
        )
        order = msg(
            "A Quaternion has the order x, y, z, w: is yours w first, or turned about x or y?"
        )
        cost = 0.0 if faults else QUATERNION
        return [*faults, WayFault(text, cost + HEADING, order)]
    errors = heading_errors(way)
    off = _usual_deg(errors)
    if abs(off) > tolerances["heading_deg"]:
        text = msg(
            "it looks {angle:.0f} degrees beside the direction in which it goes", angle=abs(off)
        )
        is_steady = bool(abs(np.exp(1j * errors).mean()) > 0.9)
        faults.append(WayFault(text, HEADING, _why_beside(off, is_steady=is_steady)))
    return faults


def _why_beside(off: float, *, is_steady: bool) -> Message:
    """What it may be that one looks so many degrees beside one's direction, all the way or not."""
    if is_steady and abs(abs(off) - 180) < 20:
        return msg("It goes backwards: turn its heading by pi, or go round the other way.")
    if is_steady and abs(abs(off) - 90) < 20:
        return msg(
            "It looks along the radius, and on a circle one goes at a right angle to that: the "
            "heading is the angle on the circle plus pi / 2, or minus where one goes clockwise."
        )
    return msg(
        "Its heading has to grow as the angle on the circle does, in radians, a quarter turn ahead "
        "of that; half of it stands in a quaternion: z = sin(heading / 2), w = cos(heading / 2)."
    )


def _usual_deg(errors: Floats) -> float:
    """The error that nine in ten are no larger than [degrees]; 0 where it does not move."""
    if not len(errors):
        return 0.0
    row = np.argsort(np.abs(errors))[int(0.9 * (len(errors) - 1))]
    return math.degrees(float(errors[row]))


def heading_errors(way: Odometry) -> Floats:
    """By how much it looks beside its direction, wherever it moves [rad], -pi to pi."""
    points, yaw = way.places[:, :2], way.yaw
    steps = points[2:] - points[:-2]  # about the point between
    moves = np.linalg.norm(steps, axis=1) > 1e-6
    goes = np.arctan2(steps[moves, 1], steps[moves, 0])
    off: Floats = (yaw[1:-1][moves] - goes + math.pi) % (2 * math.pi) - math.pi
    return off


@checks()
@of_run
def reachable(seen: RobotRun, tolerances: Tolerances) -> Finding:
    """Every link has its place in odom.

    From `odom`, tf2 finds a way to every link of the URDF; each frame has one parent, and one
    sender: the node or robot_state_publisher. All or nothing.
    """
    frames = hung(seen.trace)
    for child in (*seen.links, ODOM):
        frame = frames.get(child)
        if frame and (len(frame.parents) > 1 or len(frame.senders) > 1):
            first = next(
                t
                for t in seen.trace.transforms
                if bare(t.child) == child and t.publisher != "scene" and not why_refused(t)
            )
            rationale = msg(
                "The frame {frame!r} is sent on /tf by your node and by robot_state_publisher, "
                "and jumps between the two.",
                frame=child,
            )
            if len(frame.parents) > 1:
                rationale = msg("The frame {frame!r} has two parents on /tf, {parents}.")
                parents = listed(sorted(frame.parents))
                rationale = rationale.given(frame=child, parents=parents)
            where = (seen.moment(first.tick, msg("{frame} has two places", frame=child)),)
            return Finding(0, rationale, _ONE_TRANSFORM, where)
    reached = {ODOM, *below(ODOM, frames)}
    lost = [link for link in seen.links if link not in reached]
    if lost or not seen.links:
        note = msg("{links}: no way from {odom}", links=listed(lost), odom=ODOM)
        where = (seen.moment(seen.trace.ticks, note),)
        if refused := next((t for t in seen.sent if why_refused(t)), None):
            rationale = msg(
                "tf2 refuses your transform from {parent} to {child}: {why}",
                parent=f"{refused.parent!r:.40}",
                child=f"{refused.child!r:.40}",
                why=why_refused(refused),
            )
            return Finding(0, sentence([rationale]), _ONE_TRANSFORM, where)
        rationale = msg(
            "{count} of {total} links have no place in {odom!r}: {links}.",
            count=len(lost),
            total=len(seen.links),
            odom=ODOM,
            links=listed(lost),
        )
        return Finding(0, rationale, _ONE_TRANSFORM, where)
    return Finding(
        1, msg("All {total} links have a place in {odom!r}.", total=len(seen.links), odom=ODOM)
    )
