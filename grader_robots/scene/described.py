"""The robot of a package: what its launch file hands on, as a solid and a tree."""

from __future__ import annotations

import base64
from collections import Counter
from functools import lru_cache

import numpy as np

from grader.scenes.view import Floats, Placing, Solid, SolidFrame, Tree, TreeNode
from grader.submission import package_trace
from grader.text import NOTHING, Message, joined, msg
from grader_robots.robot_py.kinematics import forward, joint_transform, tree
from grader_robots.robot_py.model import Model
from grader_robots.robot_py.urdf import parse
from grader_robots.scene import shapes
from grader_robots.scene.shapes import MOST_NODES, descend, is_finite, name_of, named, placing

_MOST_LINKS = 400
_LARGEST = 1e9
#: A description that is longer is not drawn [characters].
_LONGEST = 500_000


def model(trace: package_trace.PackageTrace) -> Model | None:
    """The robot that is drawn; None where there is none that urdfdom takes."""
    found = _described(trace)
    return None if found is None else _model(trace.texts[found.text])


def solid(trace: package_trace.PackageTrace) -> Solid | None:
    """The robot with all joints at 0; None where there is none."""
    robot = model(trace)
    if robot is None:
        return None
    placed = forward(robot, {})
    lost = [
        link
        for link in robot.links
        if link not in placed or not is_finite(placed[link].ravel().tolist())
    ]
    joints = tree(robot).joints
    links = [*(link for link in placed if link not in lost), *lost][:_MOST_LINKS]
    numbers = {link: number for number, link in enumerate(links)}
    frames = []
    for link in numbers:
        if link in lost:
            frames.append(SolidFrame(name_of(link), -1, (None,)))
        elif link == robot.root:
            frames.append(SolidFrame(name_of(link), -1, (Placing(),)))
        else:
            where = placing(joint_transform(joints[link]))
            frames.append(SolidFrame(name_of(link), numbers[joints[link].parent], (where,)))
    found = _described(trace)
    by = name_of(found.by) if found is not None else ""
    notes = [msg("as {by} describes it, all joints at 0", by=by)]
    if lost:
        notes.append(
            msg("white, at the origin, for they hang on nothing: {names}", names=named(lost))
        )
    return shapes.solid(robot, frames, numbers, lost, notes, meshes(trace), ground_m=None)


def links(trace: package_trace.PackageTrace) -> Tree | None:
    """Which link hangs on which, by which joint; None where there is no robot."""
    robot = model(trace)
    if robot is None:
        return None
    held = tree(robot).joints
    below: dict[str, list[str]] = {}
    for link, joint in held.items():
        below.setdefault(joint.parent, []).append(link)
    claimed = Counter(joint.child for joint in robot.joints.values())
    nodes: list[TreeNode] = []
    seen: set[str] = set()
    for depth, link in descend(robot.root, below, seen):
        on = held.get(link)
        details: list[str | Message] = (
            [msg("the root")] if on is None else [name_of(on.name), on.type.value]
        )
        several = claimed[link] > 1
        if several:
            details.append(msg("claimed by {count} joints", count=claimed[link]))
        nodes.append(
            TreeNode(depth, name_of(link), joined(details, ", "), "wrong" if several else "")
        )
    lost = [link for link in robot.links if link not in seen]
    nodes += [TreeNode(0, name_of(each), msg("hangs on nothing"), "lost") for each in lost]
    more = len(nodes) - MOST_NODES
    note = msg("{count} more links are not shown.", count=more) if more > 0 else NOTHING
    return Tree(msg("Links and the joints that hold them"), tuple(nodes[:MOST_NODES]), note)


def meshes(trace: package_trace.PackageTrace) -> dict[str, Floats]:
    """By the name that the URDF gives: triangles, float64 (n, 3, 3), as far as they were read."""
    found = _described(trace)
    return {
        mesh.uri: surface
        for mesh in (found.meshes if found is not None else ())
        if mesh.surface >= 0 and (surface := _surface(trace.surfaces[mesh.surface])) is not None
    }


def _surface(encoded: str) -> Floats | None:
    """A surface of a trace; None where it is none."""
    try:
        numbers = np.frombuffer(base64.b64decode(encoded, validate=True), "<f4").astype(np.float64)
    except ValueError:
        return None
    whole = len(numbers) % 9 == 0 and (np.abs(numbers) < _LARGEST).all()
    return numbers.reshape(-1, 3, 3) if whole else None


def _described(trace: package_trace.PackageTrace) -> package_trace.Description | None:
    """The first description that a launch file hands on; else that of a file."""
    every = [each for each in trace.descriptions if each.text >= 0]
    return next((each for each in every if each.is_launched), next(iter(every), None))


@lru_cache(maxsize=4)
def _model(description: str) -> Model | None:
    if len(description) > _LONGEST:
        return None
    robot = parse(description).model
    # a circle of links below the root has no end; robot_state_publisher does not survive it
    if robot is None or len(robot.links) > 4 * _MOST_LINKS or tree(robot).is_endless:
        return None
    return robot


def words(trace: package_trace.PackageTrace) -> Message:
    """What there is to see, for who cannot."""
    if (found := solid(trace)) is not None:
        return found.text
    if _described(trace) is None:
        return msg("no robot description was found")
    return msg("the robot description cannot be drawn")
