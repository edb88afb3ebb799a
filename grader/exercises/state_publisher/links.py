"""Whether every link of the robot hangs below `odom`, by one way, and by one sender."""

from __future__ import annotations

from grader.exercise.verdict import Finding
from grader.exercises.state_publisher.naming import listed
from grader.exercises.state_publisher.seen import Seen, sentence
from grader.scenes.robot.frames import why_refused
from grader.scenes.robot.motion import ODOM, bare

HELP = (
    f"robot_state_publisher sends what lies inside of the robot, from your joint states; your node "
    f"sends one transform, from {ODOM!r} to the root link, and no other."
)


def judge_links(seen: Seen) -> Finding:
    """What a listener of tf knows at the end."""
    kept = [each for each in seen.trace.transforms if not why_refused(each)]
    parents: dict[str, set[str]] = {}
    senders: dict[str, set[str]] = {}
    for each in kept:
        parents.setdefault(bare(each.child), set()).add(bare(each.parent))
        senders.setdefault(bare(each.child), set()).add(each.publisher)
    for child in (*seen.links, ODOM):
        several = parents.get(child, set())
        if len(several) > 1 or len(senders.get(child, ())) > 1:
            first = next(t for t in kept if bare(t.child) == child and t.publisher != "scene")
            told = (
                f"has two parents on /tf, {listed(sorted(several))}"
                if len(several) > 1
                else (
                    "is sent on /tf by your node and by robot_state_publisher, and jumps between "
                    "the two"
                )
            )
            where = (seen.moment(first.tick, f"{child} has two places"),)
            return Finding(0, f"The frame {child!r} {told}.", HELP, where)
    up = {child: next(iter(several)) for child, several in parents.items()}
    lost = [link for link in seen.links if not _is_below_odom(link, up)]
    if lost or not seen.links:
        where = (seen.moment(seen.trace.ticks, f"{listed(lost)}: no way from {ODOM}"),)
        if refused := next((t for t in seen.sent if why_refused(t)), None):
            told = (
                f"tf2 refuses your transform from {refused.parent!r:.40} to {refused.child!r:.40}"
            )
            return Finding(0, sentence([f"{told}: {why_refused(refused)}"]), HELP, where)
        return Finding(
            0,
            f"{len(lost)} of {len(seen.links)} links have no place in {ODOM!r}: {listed(lost)}.",
            HELP,
            where,
        )
    return Finding(1, f"All {len(seen.links)} links have a place in {ODOM!r}.")


def _is_below_odom(link: str, up: dict[str, str]) -> bool:
    seen: set[str] = set()
    while link != ODOM:
        if link in seen or link not in up:
            return False
        seen.add(link)
        link = up[link]
    return True
