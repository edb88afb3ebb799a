"""Whether stamps are set, increase, and are one for a joint state and the transform beside it."""

from __future__ import annotations

from collections import defaultdict
from itertools import pairwise

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Evidence, Finding
from grader.exercises.state_publisher.seen import Seen, sentence
from grader.language.phrase import say

#: What each of the three is worth.
SET, INCREASE, SAME = 0.4, 0.2, 0.4


def judge_stamps(seen: Seen, tolerances: Tolerances) -> Finding:
    """All messages of the node's."""
    states, way = seen.trace.joint_states, seen.way
    if not states:
        return seen.no_joint_states()
    unset: list[tuple[int, str]] = [
        (s.tick, say("a JointState")) for s in states if s.stamp_ns == 0
    ]
    unset += [
        (t.tick, say("a transform on {topic}", topic=t.topic)) for t in seen.sent if t.stamp_ns == 0
    ]
    if unset:
        tick, what = unset[0]
        return Finding(
            0,
            say(
                "The stamp of {what} is not set: its time is 0. robot_state_publisher "
                "then sends nothing for a joint state, and tf2 finds a transform in no "
                "time.",
                what=what,
            ),
            say("Each message has a header, and that a stamp: the node's clock tells the time."),
            (seen.moment(tick, say("{what} without a time", what=what)),),
        )
    share, wrong = 1.0, []
    where: list[Evidence] = []
    back = _not_later(seen)
    if back is not None:
        share -= INCREASE
        wrong.append(say("stamps do not increase from message to message"))
        where.append(seen.moment(back, say("not later than the one before")))
    told = {state.stamp_ns for state in states}
    alone = [t for t in seen.sent if t.child.lstrip("/") == seen.root and t.stamp_ns not in told]
    if len(way) and len(alone) > (1 - tolerances["same_share"]) * len(way):
        share -= SAME
        wrong.append(
            say(
                "{count} of {total} transforms on /tf have a stamp that no joint state "
                "has: what belongs to one moment should say so",
                count=len(alone),
                total=len(way),
            )
        )
        where.append(seen.moment(alone[0].tick, say("a stamp of its own")))
    if not wrong:
        return Finding(1, say("All stamps are set, increase, and are the same in both messages."))
    return Finding(
        share,
        sentence(wrong),
        say(
            "Ask the clock once for each step, and use that time in the joint state"
            " and the transform."
        ),
        tuple(where),
    )


def _not_later(seen: Seen) -> int | None:
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
