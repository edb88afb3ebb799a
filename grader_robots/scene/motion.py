"""How a robot moved: its joints over time, the way of its root, and the frames that tf tells of."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Literal, NamedTuple, Self

import numpy as np
import numpy.typing as npt

from grader.scenes.view import Floats, Tree, TreeNode
from grader.text import NOTHING, Message, joined, msg
from grader_robots.scene.shapes import MOST_NODES, descend, name_of, named
from grader_robots.scene.trace import TF, TF_STATIC, TICK_S, RobotTrace, Transform

Ints = npt.NDArray[np.int64]

#: The frame in which a robot moves.
ODOM = "odom"
_SENDERS: dict[str, str | Message] = {
    "scene": "robot_state_publisher",
    "submission": msg("your node"),
}


class JointMotion(NamedTuple):
    """What the submission said of one joint.

    Attributes:
        ticks: when, int64 (n,).
        positions: [rad or m], float64 (n,); may be not a number.
    """

    name: str
    ticks: Ints
    positions: Floats


@dataclass(frozen=True, eq=False)
class Odometry:
    """Where the child of one transform was in its parent.

    Attributes:
        ticks: when, int64 (n,).
        places: x, y, z [m], float64 (n, 3).
        quaternions: x, y, z, w, float64 (n, 4).
    """

    ticks: Ints
    places: Floats
    quaternions: Floats

    @classmethod
    def of(cls, transforms: list[Transform]) -> Self:
        return cls(
            np.array([each.tick for each in transforms], dtype=np.int64),
            np.array([each.translation for each in transforms], dtype=np.float64).reshape(-1, 3),
            np.array([each.rotation for each in transforms], dtype=np.float64).reshape(-1, 4),
        )

    def __len__(self) -> int:
        return len(self.ticks)

    @property
    def yaw(self) -> Floats:
        """The heading [rad], of quaternions as they are, whatever their length."""
        x, y, z, w = self.quaternions.T
        with np.errstate(all="ignore"):
            heading: Floats = np.arctan2(2 * (w * z + x * y), w * w + x * x - y * y - z * z)
        return heading


def joints(trace: RobotTrace) -> dict[str, JointMotion]:
    """Every joint that the submission named in a message that can be taken, by name."""
    found: dict[str, list[tuple[int, float]]] = {}
    for state in trace.joint_states:
        if not state.is_taken:
            continue
        named = dict(zip(reversed(state.names), reversed(state.positions), strict=True))
        for name, position in named.items():  # of two of a name the first counts
            found.setdefault(name, []).append((state.tick, position))
    return {name: _joint(name, rows) for name, rows in sorted(found.items())}


def _joint(name: str, rows: list[tuple[int, float]]) -> JointMotion:
    ticks, positions = zip(*rows, strict=True)
    return JointMotion(name, np.array(ticks, dtype=np.int64), np.array(positions, dtype=np.float64))


def odometry(trace: RobotTrace) -> Odometry:
    """Where the robot's root was in `odom`, as the submission sent it on /tf."""
    root = trace.robot.model.root if trace.robot else ""
    sent = (t for t in trace.transforms if (t.topic, t.publisher) == (TF, "submission"))
    return Odometry.of([t for t in sent if (bare(t.parent), bare(t.child)) == (ODOM, root)])


def fitted(points: Floats) -> tuple[float, float, float, float]:
    """The circle nearest to points, by least squares: its centre, radius, and the usual distance.

    Kasa's fit: x² + y² = 2 a x + 2 b y + c. Not a number where the points are none, or a line.
    """
    middle = points.mean(axis=0)
    x, y = (points - middle).T
    matrix = np.column_stack((2 * x, 2 * y, np.ones(len(x))))
    (a, b, c), _, rank, _ = np.linalg.lstsq(matrix, x * x + y * y, rcond=None)
    square = c + a * a + b * b
    if rank < 3 or not square > 0:
        return math.nan, math.nan, math.nan, math.nan
    radius = math.sqrt(square)
    off = float(np.quantile(np.abs(np.hypot(x - a, y - b) - radius), 0.95))
    return float(a + middle[0]), float(b + middle[1]), radius, off


def bare(frame: str) -> str:
    """A frame's name as tf2 takes it: without the slash in front."""
    return frame.removeprefix("/")


# Frames -------------------------------------------------------------------------------------------


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
    details: list[str | Message] = [_pace(frame), joined(senders, msg(" and "))]
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
