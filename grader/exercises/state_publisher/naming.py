"""Whether joint states name the joints that the description has."""

from __future__ import annotations

from collections.abc import Iterable

from grader.exercise.verdict import Finding
from grader.exercises.state_publisher.seen import Seen
from grader.language.phrase import say, say_many


def judge_names(seen: Seen) -> Finding:
    """The names of all joint states that can be taken, against the joints that move."""
    states = seen.trace.joint_states
    if not states:
        return seen.no_joint_states()
    taken = [state for state in states if state.is_taken]
    if len(taken) < len(states):
        bad = next(state for state in states if not state.is_taken)
        return Finding(
            0.5 * len(taken) / len(states),
            say(
                "A JointState has {names} names and {positions} positions: "
                "robot_state_publisher ignores it as invalid.",
                names=len(bad.names),
                positions=len(bad.positions),
            ),
            say(
                "`name` and `position` belong together, one number for each name, in "
                "the same order."
            ),
            (seen.moment(bad.tick, say("names and positions are not as many")),),
        )
    wanted, found = set(seen.moving), set(seen.joints)
    if wanted == found:
        return Finding(1, say("The joint states name {joints}.", joints=listed(sorted(wanted))))
    missing, foreign = sorted(wanted - found), sorted(found - wanted)
    return Finding(
        len(wanted & found) / len(wanted | found),
        _mixed_up(missing, foreign),
        say(
            "Compare your names letter by letter with the <joint name=...> of the "
            "URDF: those of joints, not of links, and none of a fixed joint. "
            "robot_state_publisher skips what it does not know without a word, and "
            "the links behind it have no place."
        ),
        (
            seen.moment(
                states[0].tick, say("names {joints}", joints=listed(sorted(set(states[0].names))))
            ),
        ),
    )


def _mixed_up(missing: list[str], foreign: list[str]) -> str:
    names = {"missing": listed(missing), "foreign": listed(foreign)}
    if not foreign:
        return say("The messages on /joint_states name never {missing}.", **names)
    if not missing:
        return say_many(
            "The messages on /joint_states name {foreign}, which is none of the robot's moving "
            "joints.",
            "The messages on /joint_states name {foreign}, which are none of the robot's moving "
            "joints.",
            len(foreign),
            **names,
        )
    return say_many(
        "The messages on /joint_states name {foreign}, which is none of the robot's moving "
        "joints, and never {missing}.",
        "The messages on /joint_states name {foreign}, which are none of the robot's moving "
        "joints, and never {missing}.",
        len(foreign),
        **names,
    )


def listed(names: Iterable[str]) -> str:
    """A few names, as they may stand in a sentence."""
    each = [repr(name[:40]) for name in names]
    few = ", ".join(each[:5])
    if len(each) > 5:
        return say("{names} and {count} more", names=few, count=len(each) - 5)
    return few or say("nothing")
