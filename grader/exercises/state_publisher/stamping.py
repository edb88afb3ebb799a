"""Whether stamps are set, increase, and are one for a joint state and the transform beside it."""

from __future__ import annotations

from collections import defaultdict
from itertools import pairwise

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Evidence, Finding
from grader.exercises.state_publisher.seen import Seen, sentence

#: What each of the three is worth.
SET, INCREASE, SAME = 0.4, 0.2, 0.4


def judge_stamps(seen: Seen, tolerances: Tolerances) -> Finding:
    """All messages of the node's."""
    states, way = seen.trace.joint_states, seen.way
    if not states:
        return seen.no_joint_states()
    unset = [(s.tick, "a JointState") for s in states if s.stamp_ns == 0]
    unset += [(t.tick, f"a transform on {t.topic}") for t in seen.sent if t.stamp_ns == 0]
    if unset:
        tick, what = unset[0]
        return Finding(
            0,
            f"The stamp of {what} is not set: its time is 0. robot_state_publisher then sends "
            "nothing for a joint state, and tf2 finds a transform in no time.",
            "Each message has a header, and that a stamp: the node's clock tells the time.",
            (seen.moment(tick, f"{what} without a time"),),
        )
    share, wrong = 1.0, []
    where: list[Evidence] = []
    back = _not_later(seen)
    if back is not None:
        share -= INCREASE
        wrong.append("stamps do not increase from message to message")
        where.append(seen.moment(back, "not later than the one before"))
    told = {state.stamp_ns for state in states}
    alone = [t for t in seen.sent if t.child.lstrip("/") == seen.root and t.stamp_ns not in told]
    if len(way) and len(alone) > (1 - tolerances["same_share"]) * len(way):
        share -= SAME
        wrong.append(
            f"{len(alone)} of {len(way)} transforms on /tf have a stamp that no joint state has: "
            "what belongs to one moment should say so"
        )
        where.append(seen.moment(alone[0].tick, "a stamp of its own"))
    if not wrong:
        return Finding(1, "All stamps are set, increase, and are the same in both messages.")
    return Finding(
        share,
        sentence(wrong),
        "Ask the clock once for each step, and use that time in the joint state and the transform.",
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
