"""How often messages come, and how steadily: counted in windows, for a tick is no clock."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Finding
from grader.exercises.state_publisher.seen import Seen, sentence
from grader.language.phrase import say, say_many
from grader.scenes.robot.trace import TF, TF_STATIC, TICK_S, RobotTrace

#: So long a window is [ticks]: about half a second.
WINDOW_TICKS = 32


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


def judge_rate(seen: Seen, tolerances: Tolerances) -> Finding:
    """Joint states and transforms: rate, steadiness, and what of them is too much."""
    trace = seen.trace
    if not trace.joint_states:
        return seen.no_joint_states()
    each = [(say("joint states"), _of_one_joint(trace))]
    messages = {t.message: t.tick for t in seen.sent if t.topic == TF}
    if messages:
        each.append((say("transforms"), list(messages.values())))
    wrong: list[str] = []
    told: list[str] = []
    where = []
    for what, ticks in each:
        found = pace(ticks, trace.ticks, tolerances)
        low, high = tolerances["rate_least_hz"], tolerances["rate_most_hz"]
        said = {"what": what, "hertz": found.hertz}
        if not 0.95 * low <= found.hertz <= 1.05 * high:
            wrong.append(
                say(
                    "{what} came {hertz:.0f} times a second; expected {low} to {high}",
                    low=low,
                    high=high,
                    **said,
                )
            )
        elif found.steady < tolerances["rate_share"]:
            wrong.append(
                say(
                    "{what} came {hertz:.0f} times a second, but only {steady:.0f}% of the time",
                    steady=100 * found.steady,
                    **said,
                )
            )
        else:
            told.append(say("{what} came {hertz:.0f} times a second, steadily", **said))
            continue
        where.append(seen.moment(found.gap_tick, say("{what} do not come as usual", what=what)))
    share = 1 - len(wrong) / len(each)
    flood = _flood(seen, tolerances)
    if flood:
        wrong.append(flood)
        share = min(share, 0.5)
    if not wrong:
        return Finding(1, sentence(told))
    return Finding(
        share,
        sentence(wrong),
        say("One message of each kind, from one timer at a fixed rate, is what others can follow."),
        tuple(where),
    )


def too_seldom(seen: Seen, tolerances: Tolerances) -> str:
    """Whether joint states come so seldom that no movement can be as it should, as a clause; ''."""
    hertz = pace(_of_one_joint(seen.trace), seen.trace.ticks, tolerances).hertz
    low, high = tolerances["rate_least_hz"], tolerances["rate_most_hz"]
    if hertz >= 0.95 * low:
        return ""
    return say(
        "{what} came {hertz:.0f} times a second; expected {low} to {high}",
        what=say("joint states"),
        hertz=hertz,
        low=low,
        high=high,
    )


def _of_one_joint(trace: RobotTrace) -> list[int]:
    """The ticks of the joint that is named most often: each may have messages of its own."""
    named: dict[str, list[int]] = {}
    for state in trace.joint_states:
        for name in dict.fromkeys(state.names) or [""]:
            named.setdefault(name, []).append(state.tick)
    return max(named.values(), key=len)


def _flood(seen: Seen, tolerances: Tolerances) -> str:
    """What is sent more often than it should be, as a clause; ''."""
    static = len({t.message for t in seen.sent if t.topic == TF_STATIC})
    if static > tolerances["static_most"]:
        return say_many(
            "{n} message came on /tf_static: a StaticTransformBroadcaster is for what never moves, "
            "and sends it once",
            "{n} messages came on /tf_static: a StaticTransformBroadcaster is for what never "
            "moves, and sends it once",
            static,
        )
    per_message = Counter((t.message, t.child) for t in seen.sent)
    repeated = [key for key, number in per_message.items() if number > 1]
    if repeated:
        most = max(per_message.values())
        return say(
            "a message on /tf holds the transform of {frame} {count} times",
            frame=f"{repeated[0][1]!r:.60}",
            count=most,
        )
    return ""
