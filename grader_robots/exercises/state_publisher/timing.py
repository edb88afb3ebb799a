"""How often messages come, and how steadily, and what time they carry.

They are counted in windows, for a tick is no clock.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from grader import Checks, Evidence, Finding, Tolerances
from grader.text import NOTHING, Message, msg
from grader_robots.exercises.state_publisher.seen import RobotRun, of_run, sentence
from grader_robots.scene.trace import TF, TF_STATIC, TICK_S, RobotTrace

checks = Checks()
#: So long a window is [ticks]: about half a second.
WINDOW_TICKS = 32
#: What it is worth that stamps are set, increase, and are one for what belongs together.
INCREASE, SAME = 0.2, 0.4
_NOT_AS_OFTEN = msg("{what} came {hertz:.0f} times a second; expected {low} to {high}")


@dataclass(frozen=True)
class Pace:
    """How messages came.

    Attributes:
        hertz: the usual rate.
        steady: the share of windows that have about so many, 0 to 1.
        gap_tick: where the worst window begins.
    """

    hertz: float
    steady: float
    gap_tick: int


def pace(ticks: list[int], end: int, tolerances: Tolerances) -> Pace:
    """How messages came, from the first of them to the end of the run.

    Args:
        ticks: of each, in order; one at least.
        end: the last tick of the run.
    """
    first = ticks[0]
    edges = np.arange(first, max(end, first + WINDOW_TICKS) + 1, WINDOW_TICKS)
    counts, _ = np.histogram(ticks, edges)
    usual = float(np.median(counts))
    near = np.abs(counts - usual) <= np.maximum(1.01, tolerances["rate_deviation"] * usual)
    worst = int(np.argmax(np.abs(counts - usual)))
    return Pace(usual / (WINDOW_TICKS * TICK_S), float(near.mean()), int(edges[worst]))


@checks()
@of_run
def publishes(seen: RobotRun, tolerances: Tolerances) -> Finding:
    """It publishes steadily.

    Joint states come {rate_least_hz} to {rate_most_hz} times a second, and for {rate_share%} of the
    time their number in half a second is off the usual by {rate_deviation%} at most: half of the
    points. The same holds for the node's transforms on /tf, if it sends any: the other half. Half
    at most for more than {static_most} messages on /tf_static, or a message that holds the same
    transform twice.
    """
    trace = seen.trace
    if not trace.joint_states:
        return seen.no_joint_states()
    each = [(msg("joint states"), _of_one_joint(trace))]
    messages = {t.message: t.tick for t in seen.sent if t.topic == TF}
    if messages:
        each.append((msg("transforms"), list(messages.values())))
    wrong: list[Message] = []
    good: list[Message] = []
    where = []
    for what, ticks in each:
        found = pace(ticks, trace.ticks, tolerances)
        low, high = tolerances["rate_least_hz"], tolerances["rate_most_hz"]
        values = {"what": what, "hertz": found.hertz}
        if not 0.95 * low <= found.hertz <= 1.05 * high:
            wrong.append(_NOT_AS_OFTEN.given(low=low, high=high, **values))
        elif found.steady < tolerances["rate_share"]:
            unsteady = msg(
                "{what} came {hertz:.0f} times a second, but only {steady:.0f}% of the time",
                steady=100 * found.steady,
                **values,
            )
            wrong.append(unsteady)
        else:
            good.append(msg("{what} came {hertz:.0f} times a second, steadily", **values))
            continue
        where.append(seen.moment(found.gap_tick, msg("{what} do not come as usual", what=what)))
    share = 1 - len(wrong) / len(each)
    flood = _flood(seen, tolerances)
    if flood:
        wrong.append(flood)
        share = min(share, 0.5)
    if not wrong:
        return Finding(1, sentence(good))
    help = msg(
        "One message of each kind, from one timer at a fixed rate, is what others can follow."
    )
    return Finding(share, sentence(wrong), help, tuple(where))


def too_seldom(seen: RobotRun, tolerances: Tolerances) -> Message:
    """Whether joint states come so seldom that no movement can be as it should, as a clause; ''."""
    hertz = pace(_of_one_joint(seen.trace), seen.trace.ticks, tolerances).hertz
    low, high = tolerances["rate_least_hz"], tolerances["rate_most_hz"]
    if hertz >= 0.95 * low:
        return NOTHING
    return _NOT_AS_OFTEN.given(what=msg("joint states"), hertz=hertz, low=low, high=high)


def _of_one_joint(trace: RobotTrace) -> list[int]:
    """The ticks of the joint that is named most often: each may have messages of its own."""
    named: dict[str, list[int]] = {}
    for state in trace.joint_states:
        for name in dict.fromkeys(state.names) or [""]:
            named.setdefault(name, []).append(state.tick)
    return max(named.values(), key=len)


def _flood(seen: RobotRun, tolerances: Tolerances) -> Message:
    """What is sent more often than it should be, as a clause; ''."""
    static = len({t.message for t in seen.sent if t.topic == TF_STATIC})
    if static > tolerances["static_most"]:
        return msg(
            "{n} message came on /tf_static: a StaticTransformBroadcaster is for what never moves, "
            "and sends it once",
            "{n} messages came on /tf_static: a StaticTransformBroadcaster is for what never "
            "moves, and sends it once",
            n=static,
        )
    per_message = Counter((t.message, t.child) for t in seen.sent)
    repeated = [key for key, number in per_message.items() if number > 1]
    if repeated:
        most = max(per_message.values())
        return msg(
            "a message on /tf holds the transform of {frame} {count} times",
            frame=f"{repeated[0][1]!r:.60}",
            count=most,
        )
    return NOTHING


@checks()
@of_run
def stamps(seen: RobotRun, tolerances: Tolerances) -> Finding:
    """The messages carry the time.

    No stamp is 0; else there are no points. From message to message they increase (1/5 of the
    points), and {same_share%} of the transforms have the stamp of a joint state (2/5).
    """
    states, way = seen.trace.joint_states, seen.way
    if not states:
        return seen.no_joint_states()
    unset: list[tuple[int, Message]] = [
        (s.tick, msg("a JointState")) for s in states if s.stamp_ns == 0
    ]
    unset += [
        (t.tick, msg("a transform on {topic}", topic=t.topic)) for t in seen.sent if t.stamp_ns == 0
    ]
    if unset:
        tick, what = unset[0]
        rationale = msg(
            "The stamp of {what} is not set: its time is 0. robot_state_publisher then sends "
            "nothing for a joint state, and tf2 finds a transform in no time.",
            what=what,
        )
        help = msg("Each message has a header, and that a stamp: the node's clock tells the time.")
        timeless = (seen.moment(tick, msg("{what} without a time", what=what)),)
        return Finding(0, rationale, help, timeless)
    share = 1.0
    wrong: list[Message] = []
    where: list[Evidence] = []
    back = _not_later(seen)
    if back is not None:
        share -= INCREASE
        wrong.append(msg("stamps do not increase from message to message"))
        where.append(seen.moment(back, msg("not later than the one before")))
    stamps = {state.stamp_ns for state in states}
    alone = [t for t in seen.sent if t.child.lstrip("/") == seen.root and t.stamp_ns not in stamps]
    if len(way) and len(alone) > (1 - tolerances["same_share"]) * len(way):
        share -= SAME
        apart = msg(
            "{count} of {total} transforms on /tf have a stamp that no joint state "
            "has: what belongs to one moment should say so",
            count=len(alone),
            total=len(way),
        )
        wrong.append(apart)
        where.append(seen.moment(alone[0].tick, msg("a stamp of its own")))
    if not wrong:
        return Finding(1, msg("All stamps are set, increase, and are the same in both messages."))
    help = msg(
        "Ask the clock once for each step, and use that time in the joint state and the transform."
    )
    return Finding(share, sentence(wrong), help, tuple(where))


def _not_later(seen: RobotRun) -> int | None:
    """The first tick at which a joint or a frame has no later stamp than before."""
    stamps: dict[str, list[tuple[int, int]]] = defaultdict(list)
    for state in seen.trace.joint_states:
        for name in dict.fromkeys(state.names):
            stamps[f"joint {name}"].append((state.stamp_ns, state.tick))
    once = {(t.message, t.child): t for t in seen.sent}  # twice in one message is told elsewhere
    for t in once.values():
        stamps[f"frame {t.child}"].append((t.stamp_ns, t.tick))
    late = [b[1] for rows in stamps.values() for a, b in pairwise(rows) if b[0] <= a[0]]
    return min(late, default=None)
