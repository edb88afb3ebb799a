"""Joint states: whether they name the robot's joints, and each joint moves as one of its kind.

A continuous joint turns on, the others go to and fro.
"""

from __future__ import annotations

import math

import numpy as np

from grader import Checks, Evidence, Expected, Finding, Tolerances
from grader.scenes.view import Floats
from grader.text import NOTHING, Message, joined, msg
from grader_robots.exercises.state_publisher.seen import (
    RobotRun,
    finite,
    listed,
    of_run,
    rounded,
    sentence,
)
from grader_robots.exercises.state_publisher.timing import too_seldom
from grader_robots.robot_py.model import JointType
from grader_robots.scene.motion import JointMotion
from grader_robots.scene.view import curve_of

checks = Checks()
HELP = msg(
    "Angles in a JointState are in radians, lengths in metres. A joint that"
    " turns on has a position that grows each time; one that goes to and "
    "fro changes its direction where it has gone far enough."
)
#: What a joint does that does not move.
STILL = msg("stays at {position:.4g}")


@checks()
@of_run
def joint_names(seen: RobotRun, tolerances: Tolerances) -> Finding:
    """The joint states name the robot's joints.

    All joints of the URDF that move are named, and no others: the points are the number of names
    in both, divided by the number of names in either. A joint state with more or fewer positions
    than names is ignored by robot_state_publisher: half of the points at most, less by the share of
    such messages.
    """
    states = seen.trace.joint_states
    if not states:
        return seen.no_joint_states()
    taken = [state for state in states if state.is_taken]
    if len(taken) < len(states):
        bad = next(state for state in states if not state.is_taken)
        rationale = msg(
            "A JointState has {names} names and {positions} positions: "
            "robot_state_publisher ignores it as invalid.",
            names=len(bad.names),
            positions=len(bad.positions),
        )
        help = msg(
            "`name` and `position` belong together, one number for each name, in the same order."
        )
        where = (seen.moment(bad.tick, msg("names and positions are not as many")),)
        return Finding(0.5 * len(taken) / len(states), rationale, help, where)
    wanted, found = set(seen.moving), set(seen.joints)
    if wanted == found:
        return Finding(1, msg("The joint states name {joints}.", joints=listed(sorted(wanted))))
    missing, foreign = sorted(wanted - found), sorted(found - wanted)
    help = msg(
        "Compare your names letter by letter with the <joint name=...> of the URDF: those of "
        "joints, not of links, and none of a fixed joint. robot_state_publisher skips what it "
        "does not know without a word, and the links behind it have no place."
    )
    note = msg("names {joints}", joints=listed(sorted(set(states[0].names))))
    where = (seen.moment(states[0].tick, note),)
    share = len(wanted & found) / len(wanted | found)
    texts = []
    if foreign:
        several = msg(
            "The messages on /joint_states name {foreign}, which is none of the robot's moving "
            "joints.",
            "The messages on /joint_states name {foreign}, which are none of the robot's moving "
            "joints.",
            n=len(foreign),
            foreign=listed(foreign),
        )
        texts.append(several)
    if missing:
        never = msg("The messages on /joint_states name never {missing}.")
        texts.append(never.given(missing=listed(missing)))
    return Finding(share, joined(texts, " "), help, where)


@checks()
@of_run
def joints_move(seen: RobotRun, tolerances: Tolerances) -> Finding:
    """The joints move as they should.

    A continuous joint turns on, one way for 95 % of the time, by {turn_least_rad} rad at least and
    by no more than {turn_most} rad/s. A revolute one goes to and fro, {swing_least_rad} to
    {swing_most_rad} rad wide, a prismatic one {push_least_m} to {push_most_m} m wide; both turn
    back {returns} times at least, and go step by step. The points are the part of the joints that
    do. Limits in the URDF do not count.
    """
    if not seen.trace.joint_states:
        return seen.no_joint_states()
    if not seen.joints.keys() & seen.moving.keys():
        names = joint_names(seen.recordings, tolerances)
        return Finding(0, names.rationale, names.help, names.evidence)
    good: list[Message] = []
    wrong: list[Message] = []
    where: list[Evidence] = []
    for name, joint in seen.moving.items():
        motion = seen.joints.get(name)
        if motion is None or len(motion.positions) < tolerances["least_messages"]:
            wrong.append(msg("{joint!r} has no positions to move by", joint=name))
            continue
        fault, seen_of_it = _judge(motion, joint.type, tolerances)
        if fault:
            wrong.append(msg("{joint!r} {movement}", joint=name, movement=fault))
            note = msg("{joint}: {movement}", joint=name, movement=fault)
            where.append(seen.moment(int(motion.ticks[-1]), note))
        else:
            good.append(msg("{joint!r} {movement}", joint=name, movement=seen_of_it))
    share = len(good) / max(len(seen.moving), 1)
    help = HELP
    if wrong and all(map(_is_still, wrong)):
        help = msg("What makes the position grow each time: is it there, and is it ever reached?")
    if wrong and (seldom := too_seldom(seen, tolerances)):
        wrong.insert(0, seldom)
        help = msg("create_timer() takes seconds: 1 / 30 calls you thirty times a second.")
    wanted = tuple(_wanted(seen, name, tolerances) for name in seen.moving)
    return Finding(share, sentence(wrong or good), help, tuple(where), expected=wanted)


def _is_still(wrong: Message) -> bool:
    movement = wrong.values.get("movement")
    return isinstance(movement, Message) and movement.key == STILL.key


def _wanted(seen: RobotRun, name: str, tolerances: Tolerances) -> Expected:
    """What a joint should do, for its plot: of a width, about the middle of what it did."""
    kind = seen.moving[name].type
    curve = curve_of(name)
    if kind == JointType.CONTINUOUS:
        text = msg("turns on, one way, by {least:.4g} rad at least and {most:.4g} rad/s at most")
        least, most = (rounded(tolerances[name]) for name in ("turn_least_rad", "turn_most"))
        return Expected(curve, text.given(least=least, most=most))
    unit, (least, most) = _width(kind, tolerances)
    text = msg("to and fro, {least:.4g} to {most:.4g} {unit} wide")
    text = text.given(least=rounded(least), most=rounded(most), unit=unit)
    positions = finite(seen.joints[name].positions) if name in seen.joints else np.empty(0)
    if not len(positions):
        return Expected(curve, text)
    middle = float(positions.min() + positions.max()) / 2
    return Expected(
        curve,
        text,
        within=(middle - most / 2, middle + most / 2),
        beyond=(middle - least / 2, middle + least / 2),
    )


def _width(kind: JointType, tolerances: Tolerances) -> tuple[str, tuple[float, float]]:
    """The unit of a joint that goes to and fro, and how wide it should."""
    if kind == JointType.PRISMATIC:
        return "m", (tolerances["push_least_m"], tolerances["push_most_m"])
    return "rad", (tolerances["swing_least_rad"], tolerances["swing_most_rad"])


def _judge(joint: JointMotion, kind: JointType, tolerances: Tolerances) -> tuple[Message, Message]:
    """What is wrong with its movement; or '', and how it moves."""
    positions = finite(joint.positions)
    if len(positions) < len(joint.positions):
        return msg("has positions that are no numbers"), NOTHING
    if float(np.ptp(positions)) < 1e-6:
        return STILL.given(position=rounded(positions[0])), NOTHING
    duration_s = max(float(joint.ticks[-1] - joint.ticks[0]) * 0.016, 0.016)
    if kind == JointType.CONTINUOUS:
        return _turns(positions, duration_s, tolerances)
    unit, span = _width(kind, tolerances)
    return _swings(positions, unit, span, tolerances)


def _turns(positions: Floats, duration_s: float, tolerances: Tolerances) -> tuple[Message, Message]:
    """On and on, one way; a turn more or less is the same place."""
    raw = np.diff(positions)
    steps = (raw + math.pi) % (2 * math.pi) - math.pi
    jumps = np.abs(raw - steps) > 1e-6  # by whole turns
    speed = float(np.abs(steps[~jumps]).sum() / duration_s) if (~jumps).any() else math.inf
    if jumps.mean() > 0.2 or speed > tolerances["turn_most"]:
        spin = float(np.median(np.abs(raw)) * len(raw) / duration_s)
        return msg("turns by {speed:.0f} rad/s, as if in degrees", speed=spin), NOTHING
    moved = steps[np.abs(steps) > 1e-9]
    one_way = max((moved > 0).mean(), (moved < 0).mean()) if len(moved) else 0.0
    total = abs(float(steps.sum()))
    if one_way < tolerances["one_way"]:
        return msg("turns to and fro; it should turn on, one way"), NOTHING
    if total < tolerances["turn_least_rad"]:
        return msg(
            "turns by {angle:.2f} rad in {duration_s:.0f} s; that is hardly seen",
            angle=total,
            duration_s=duration_s,
        ), NOTHING
    return NOTHING, msg("turns on, by {speed:.2f} rad/s", speed=speed)


def _swings(
    positions: Floats, unit: str, span: tuple[float, float], tolerances: Tolerances
) -> tuple[Message, Message]:
    """To and fro, within a span that such a joint has."""
    low, high = float(positions.min()), float(positions.max())
    wide = high - low
    seen = {"low": rounded(low), "high": rounded(high), "unit": unit}
    if wide > span[1]:
        return msg(
            "goes from {low:.4g} to {high:.4g} {unit}, {wide:.3g} {unit} wide, as if in {meant}",
            wide=wide,
            meant="°" if unit == "rad" else "cm",
            **seen,
        ), NOTHING
    if wide < span[0]:
        return msg("goes from {low:.4g} to {high:.4g} {unit}: that is hardly seen", **seen), NOTHING
    returns = turning_points(positions, wide / 4)
    if returns < tolerances["returns"]:
        return msg(
            "goes from {low:.4g} to {high:.4g} {unit} and turns back {returns} times; it should go "
            "to and fro",
            returns=returns,
            **seen,
        ), NOTHING
    steps = np.abs(np.diff(positions))
    if float(np.quantile(steps, 0.99)) > tolerances["jump_share"] * wide:
        return msg(
            "goes from {low:.4g} to {high:.4g} {unit} in jumps, not step by step", **seen
        ), NOTHING
    return NOTHING, msg("goes from {low:.4g} to {high:.4g} {unit}, to and fro", **seen)


def turning_points(values: Floats, least: float) -> int:
    """How often values turn back by so much at least."""
    count, direction, extreme = 0, 0, float(values[0])
    for value in values.tolist():
        if direction == 0:
            if abs(value - extreme) >= least:
                direction, extreme = (1 if value > extreme else -1), value
        elif (value - extreme) * direction > 0:
            extreme = value
        elif (extreme - value) * direction >= least:
            count, direction, extreme = count + 1, -direction, value
    return count
