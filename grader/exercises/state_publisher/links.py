"""Whether every link of the robot hangs below `odom`, by one way, and by one sender."""

from __future__ import annotations

from grader.exercise.verdict import Finding
from grader.exercises.state_publisher.naming import listed
from grader.exercises.state_publisher.seen import Seen, sentence
from grader.language.phrase import say
from grader.scenes.robot.frames import why_refused
from grader.scenes.robot.motion import ODOM, bare

HELP = say(
    "robot_state_publisher sends what lies inside of the robot, from your "
    "joint states; your node sends one transform, from {odom!r} to the root"
    " link, and no other.",
    odom=ODOM,
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
                say(
                    "The frame {frame!r} has two parents on /tf, {parents}.",
                    frame=child,
                    parents=listed(sorted(several)),
                )
                if len(several) > 1
                else say(
                    "The frame {frame!r} is sent on /tf by your node and by robot_state_publisher, "
                    "and jumps between the two.",
                    frame=child,
                )
            )
            where = (seen.moment(first.tick, say("{frame} has two places", frame=child)),)
            return Finding(0, told, HELP, where)
    up = {child: next(iter(several)) for child, several in parents.items()}
    lost = [link for link in seen.links if not _is_below_odom(link, up)]
    if lost or not seen.links:
        note = say("{links}: no way from {odom}", links=listed(lost), odom=ODOM)
        where = (seen.moment(seen.trace.ticks, note),)
        if refused := next((t for t in seen.sent if why_refused(t)), None):
            told = say(
                "tf2 refuses your transform from {parent} to {child}: {why}",
                parent=f"{refused.parent!r:.40}",
                child=f"{refused.child!r:.40}",
                why=why_refused(refused),
            )
            return Finding(0, sentence([told]), HELP, where)
        return Finding(
            0,
            say(
                "{count} of {total} links have no place in {odom!r}: {links}.",
                count=len(lost),
                total=len(seen.links),
                odom=ODOM,
                links=listed(lost),
            ),
            HELP,
            where,
        )
    return Finding(
        1, say("All {total} links have a place in {odom!r}.", total=len(seen.links), odom=ODOM)
    )


def _is_below_odom(link: str, up: dict[str, str]) -> bool:
    seen: set[str] = set()
    while link != ODOM:
        if link in seen or link not in up:
            return False
        seen.add(link)
        link = up[link]
    return True
