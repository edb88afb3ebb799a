"""Whether joint states name the joints that the description has."""

from __future__ import annotations

from collections.abc import Iterable

from grader.exercise.verdict import Finding
from grader.exercises.state_publisher.seen import Seen


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
            f"A JointState has {len(bad.names)} names and {len(bad.positions)} positions: "
            "robot_state_publisher ignores it as invalid.",
            "`name` and `position` belong together, one number for each name, in the same order.",
            (seen.moment(bad.tick, "names and positions are not as many"),),
        )
    wanted, found = set(seen.moving), set(seen.joints)
    if wanted == found:
        return Finding(1, f"The joint states name {listed(sorted(wanted))}.")
    missing, foreign = sorted(wanted - found), sorted(found - wanted)
    parts = []
    if foreign:
        are = "is" if len(foreign) == 1 else "are"
        parts.append(f"{listed(foreign)}, which {are} none of the robot's moving joints")
    if missing:
        parts.append(f"never {listed(missing)}")
    return Finding(
        len(wanted & found) / len(wanted | found),
        f"The messages on /joint_states name {', and '.join(parts)}.",
        "Compare your names letter by letter with the <joint name=...> of the URDF: those of "
        "joints, not of links, and none of a fixed joint. robot_state_publisher skips what it "
        "does not know without a word, and the links behind it have no place.",
        (seen.moment(states[0].tick, f"names {listed(sorted(set(states[0].names)))}"),),
    )


def listed(names: Iterable[str]) -> str:
    """A few names, as they may stand in a sentence."""
    each = [repr(name[:40]) for name in names]
    more = f" and {len(each) - 5} more" if len(each) > 5 else ""
    return ", ".join(each[:5]) + more if each else "nothing"
