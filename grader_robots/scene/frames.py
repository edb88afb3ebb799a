"""tf as it was heard: which frame hangs on which, who says so, and how often."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Literal

from grader.recording import Tree, TreeNode
from grader.text import NOTHING, Message, Text, joined, msg, series
from grader_robots.scene.decoding import Transform
from grader_robots.scene.motion import ODOM, bare
from grader_robots.scene.shapes import MOST_NODES, descend, name_of, named
from grader_robots.scene.trace import TF_STATIC, TICK_S, RobotTrace

_SENDERS: dict[str, Text] = {"scene": "robot_state_publisher", "submission": msg("your node")}


@dataclass
class Hung:
    """A frame that hangs on another.

    Attributes:
        parent: on which, as it was said last.
        parents: all of which it was said.
        senders: who said it.
        is_static: whether it was said on /tf_static, at last.
        transforms: those to its last parent, as they came.
    """

    parent: str
    parents: set[str] = field(default_factory=set)
    senders: set[str] = field(default_factory=set)
    is_static: bool = False
    transforms: list[Transform] = field(default_factory=list)


def why_refused(transform: Transform) -> Message:
    """Why tf2 does not keep a transform that it hears, as a clause; ''."""
    numbers = (*transform.translation, *transform.rotation)
    parent, child = bare(transform.parent), bare(transform.child)
    if not parent or not child:
        return msg("a frame has no name")
    if parent == child:
        return msg("the two are one")
    if not all(map(math.isfinite, numbers)):
        return msg("it holds what is no number")
    if not any(transform.rotation):
        return msg("its quaternion is all zeros, which turns nothing")
    return NOTHING


def hung(trace: RobotTrace) -> dict[str, Hung]:
    """Every frame that hangs on another, by name, as a listener knows it at the end."""
    found: dict[str, Hung] = {}
    for each in trace.transforms:
        if why_refused(each):
            continue
        child, parent = bare(each.child), bare(each.parent)
        one = found.setdefault(child, Hung(parent))
        if one.parent != parent:
            one.parent, one.transforms = parent, []
        one.parents.add(parent)
        one.senders.add(each.publisher)
        one.is_static = each.topic == TF_STATIC
        one.transforms.append(each)
    return found


def below(root: str, frames: dict[str, Hung]) -> list[str]:
    """All that hang on a frame, each after the one that it hangs on."""
    return [name for _, name in descend(root, _children(frames), set())][1:]


def tree(trace: RobotTrace) -> Tree | None:
    """The frames as a tree; None where nothing was heard of it."""
    frames = hung(trace)
    if not frames:
        return None
    links = tuple(trace.robot.model.links) if trace.robot else ()
    reached = {ODOM, *below(ODOM, frames)}
    nodes = list(_nodes(frames, links, reached))
    lost = [link for link in links if link not in reached]
    note = (
        msg(
            "{count} of {total} links of the robot have no place in {odom}: {links}.",
            count=len(lost),
            total=len(links),
            odom=ODOM,
            links=named(lost),
        )
        if lost
        else msg("Every link of the robot has a place in {odom}.", odom=ODOM)
    )
    if len(nodes) > MOST_NODES:
        note = joined(
            [note, msg(" {count} more frames are not shown.", count=len(nodes) - MOST_NODES)]
        )
    return Tree(msg("Frames, as tf2 knows them at the end"), tuple(nodes[:MOST_NODES]), note)


def _nodes(
    frames: dict[str, Hung], links: tuple[str, ...], reached: set[str]
) -> Iterator[TreeNode]:
    """From the roots down; then what goes round in a circle, and links that hang on nothing."""
    children = _children(frames)
    roots = [name for name in children if name not in frames]
    roots.sort(key=lambda name: (name != ODOM, name))
    seen: set[str] = set()
    for start in (*roots, *frames):
        for depth, name in descend(start, children, seen):
            is_lost = name in links and name not in reached
            yield _node(depth, name, frames.get(name), is_lost)
    for link in links:
        if link not in seen:
            yield TreeNode(0, name_of(link), msg("no transform"), "lost")


def _node(depth: int, name: str, frame: Hung | None, is_lost: bool) -> TreeNode:
    mark: Literal["", "lost", "wrong"] = "lost" if is_lost else ""
    if frame is None:
        return TreeNode(depth, name_of(name), msg("hangs on nothing"), mark)
    senders = sorted((_SENDERS[each] for each in frame.senders), key=str)
    details: list[Text] = [_pace(frame), series(senders)]
    if depth == 0:
        details.append(msg("goes round in a circle by {frame}", frame=name_of(frame.parent)))
    if len(frame.parents) > 1:
        details.append(msg("parents: {names}", names=named(sorted(frame.parents))))
    if depth == 0 or len(frame.parents) > 1 or len(frame.senders) > 1:
        mark = "wrong"
    return TreeNode(depth, name_of(name), joined(details, ", "), mark)


def _pace(frame: Hung) -> Message:
    if frame.is_static:
        return msg("static")
    first, last = frame.transforms[0], frame.transforms[-1]
    duration_s = (last.tick - first.tick) * TICK_S
    if not duration_s:
        return msg("{count} times", count=len(frame.transforms))
    return msg("{rate:.1f} Hz", rate=(len(frame.transforms) - 1) / duration_s)


def _children(frames: dict[str, Hung]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for child, one in sorted(frames.items()):
        found.setdefault(one.parent, []).append(child)
    return found
