"""Whether each joint moves as a joint of its kind should: turns on, or goes to and fro."""

from __future__ import annotations

import math

import numpy as np

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Evidence, Expected, Finding
from grader.exercises.state_publisher.naming import judge_names
from grader.exercises.state_publisher.rate import too_seldom
from grader.exercises.state_publisher.seen import Seen, finite, rounded, sentence
from grader.language.phrase import say
from grader.scenes.robot.motion import Floats, Joint
from grader.scenes.robot.view import curve_of
from robot_py.model import JointType

HELP = say(
    "Angles in a JointState are in radians, lengths in metres. A joint that"
    " turns on has a position that grows each time; one that goes to and "
    "fro changes its direction where it has gone far enough."
)


def judge_moves(seen: Seen, tolerances: Tolerances) -> Finding:
    """Each joint of the description that moves."""
    if not seen.trace.joint_states:
        return seen.no_joint_states()
    if not seen.joints.keys() & seen.moving.keys():
        names = judge_names(seen)
        return Finding(0, names.rationale, names.help, names.evidence)
    told: list[str] = []
    wrong: list[str] = []
    where: list[Evidence] = []
    for name, joint in seen.moving.items():
        said = seen.joints.get(name)
        if said is None or len(said.positions) < tolerances["least_messages"]:
            wrong.append(say("{joint!r} has no positions to move by", joint=name))
            continue
        fault, seen_of_it = _judge(said, joint.type, tolerances)
        if fault:
            wrong.append(say("{joint!r} {movement}", joint=name, movement=fault))
            where.append(
                seen.moment(
                    int(said.ticks[-1]), say("{joint}: {movement}", joint=name, movement=fault)
                )
            )
        else:
            told.append(say("{joint!r} {movement}", joint=name, movement=seen_of_it))
    share = len(told) / max(len(seen.moving), 1)
    help = HELP
    if wrong and all("stays at" in each for each in wrong):
        help = say("What makes the position grow each time: is it there, and is it ever reached?")
    if wrong and (seldom := too_seldom(seen, tolerances)):
        wrong.insert(0, seldom)
        help = say("create_timer() takes seconds: 1 / 30 calls you thirty times a second.")
    wanted = tuple(_wanted(seen, name, tolerances) for name in seen.moving)
    return Finding(share, sentence(wrong or told), help, tuple(where), expected=wanted)


def _wanted(seen: Seen, name: str, tolerances: Tolerances) -> Expected:
    """What a joint should do, for its plot: of a width, about the middle of what it did."""
    kind = seen.moving[name].type
    curve = curve_of(name)
    if kind == JointType.CONTINUOUS:
        text = say(
            "turns on, one way, by {least:.4g} rad at least and {most:.4g} rad/s at most",
            least=rounded(tolerances["turn_least_rad"]),
            most=rounded(tolerances["turn_most"]),
        )
        return Expected(curve, text)
    unit, (least, most) = _width(kind, tolerances)
    text = say(
        "to and fro, {least:.4g} to {most:.4g} {unit} wide",
        least=rounded(least),
        most=rounded(most),
        unit=unit,
    )
    said = finite(seen.joints[name].positions) if name in seen.joints else np.empty(0)
    if not len(said):
        return Expected(curve, text)
    middle = float(said.min() + said.max()) / 2
    return Expected(
        *(curve, text),
        within=(middle - most / 2, middle + most / 2),
        beyond=(middle - least / 2, middle + least / 2),
    )


def _width(kind: JointType, tolerances: Tolerances) -> tuple[str, tuple[float, float]]:
    """The unit of a joint that goes to and fro, and how wide it should."""
    if kind == JointType.PRISMATIC:
        return "m", (tolerances["push_least_m"], tolerances["push_most_m"])
    return "rad", (tolerances["swing_least_rad"], tolerances["swing_most_rad"])


def _judge(joint: Joint, kind: JointType, tolerances: Tolerances) -> tuple[str, str]:
    """What is wrong with its movement; or '', and how it moves."""
    positions = finite(joint.positions)
    if len(positions) < len(joint.positions):
        return say("has positions that are no numbers"), ""
    if float(np.ptp(positions)) < 1e-6:
        return say("stays at {position:.4g}", position=rounded(positions[0])), ""
    duration_s = max(float(joint.ticks[-1] - joint.ticks[0]) * 0.016, 0.016)
    if kind == JointType.CONTINUOUS:
        return _turns(positions, duration_s, tolerances)
    unit, span = _width(kind, tolerances)
    return _swings(positions, unit, span, tolerances)


def _turns(positions: Floats, duration_s: float, tolerances: Tolerances) -> tuple[str, str]:
    """On and on, one way; a turn more or less is the same place."""
    raw = np.diff(positions)
    steps = (raw + math.pi) % (2 * math.pi) - math.pi
    jumps = np.abs(raw - steps) > 1e-6  # by whole turns
    speed = float(np.abs(steps[~jumps]).sum() / duration_s) if (~jumps).any() else math.inf
    if jumps.mean() > 0.2 or speed > tolerances["turn_most"]:
        spin = float(np.median(np.abs(raw)) * len(raw) / duration_s)
        return say("turns by {speed:.0f} rad/s, as if in degrees", speed=spin), ""
    moved = steps[np.abs(steps) > 1e-9]
    one_way = max((moved > 0).mean(), (moved < 0).mean()) if len(moved) else 0.0
    total = abs(float(steps.sum()))
    if one_way < tolerances["one_way"]:
        return say("turns to and fro; it should turn on, one way"), ""
    if total < tolerances["turn_least_rad"]:
        return say(
            "turns by {angle:.2f} rad in {duration_s:.0f} s; that is hardly seen",
            angle=total,
            duration_s=duration_s,
        ), ""
    return "", say("turns on, by {speed:.2f} rad/s", speed=speed)


def _swings(
    positions: Floats, unit: str, span: tuple[float, float], tolerances: Tolerances
) -> tuple[str, str]:
    """To and fro, within a span that such a joint has."""
    low, high = float(positions.min()), float(positions.max())
    wide = high - low
    seen = {"low": rounded(low), "high": rounded(high), "unit": unit}
    if wide > span[1]:
        if unit == "rad":
            return say(
                "goes from {low:.4g} to {high:.4g} {unit}, {wide:.3g} {unit} wide, as if in "
                "degrees",
                wide=wide,
                **seen,
            ), ""
        return say(
            "goes from {low:.4g} to {high:.4g} {unit}, {wide:.3g} {unit} wide, as if in "
            "centimetres",
            wide=wide,
            **seen,
        ), ""
    if wide < span[0]:
        return say("goes from {low:.4g} to {high:.4g} {unit}: that is hardly seen", **seen), ""
    returns = turning_points(positions, wide / 4)
    if returns < tolerances["returns"]:
        return say(
            "goes from {low:.4g} to {high:.4g} {unit} and turns back {returns} times; it should go "
            "to and fro",
            returns=returns,
            **seen,
        ), ""
    steps = np.abs(np.diff(positions))
    if float(np.quantile(steps, 0.99)) > tolerances["jump_share"] * wide:
        return say(
            "goes from {low:.4g} to {high:.4g} {unit} in jumps, not step by step", **seen
        ), ""
    return "", say("goes from {low:.4g} to {high:.4g} {unit}, to and fro", **seen)


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
