"""A robot's description as shapes that a page can turn; for every scene that has a robot."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import Any

import numpy as np

from grader.scenes.view import Floats, Placing, Shape, Solid, SolidFrame
from grader.text import Message, joined, listed, msg, shown
from grader_robots.robot_py.kinematics import matrix, quaternion, translation
from grader_robots.robot_py.model import Box, Colour, Cylinder, Geometry, Model, Sphere, Visual

#: A page has no more shapes, and no more triangles of meshes.
MOST_SHAPES, MOST_TRIANGLES = 400, 8000
#: A tree has no more nodes: a submission can send any number of frames.
MOST_NODES = 150
LONGEST_NAME = 60
_FARTHEST = 1e6
#: Of a shape with a texture, which is not known; and of one without a material, as in RViz.
_WHITE: Colour = (1.0, 1.0, 1.0, 1.0)
_RED: Colour = (1.0, 0.0, 0.0, 1.0)


def _shapes(
    model: Model, numbers: Mapping[str, int], meshes: Mapping[str, Floats]
) -> tuple[tuple[Shape, ...], tuple[str, ...]]:
    """What the links look like, and what of that is left out, in words.

    Args:
        numbers: of each link, of which frame it is the shape.
        meshes: by the name that the URDF gives: triangles, float64 (n, 3, 3).
    """
    found: list[Shape] = []
    left_out: dict[str, None] = {}
    triangles = 0
    for link in model.links.values():
        for visual in link.visuals:
            colour = _colour(visual)
            sizes = _sizes(visual.geometry, meshes)
            triangles += len(sizes) // 9
            pose = placing(matrix(visual.origin))
            fits = sizes and is_finite((*sizes, *pose.at, *pose.turned)) and link.name in numbers
            if not fits or len(found) >= MOST_SHAPES or triangles > MOST_TRIANGLES:
                named = getattr(visual.geometry, "filename", f"a shape of {link.name}")
                left_out[name_of(named)] = None
            elif colour[3] > 0:
                kind = _KINDS.get(type(visual.geometry).__name__, "triangles")
                number = numbers[link.name]
                found.append(Shape(kind, number, pose, sizes, _hex(colour), colour[3]))  # type: ignore[arg-type]
    return tuple(found), tuple(left_out)


def solid(
    model: Model,
    frames: Sequence[SolidFrame],
    numbers: Mapping[str, int],
    lost: Sequence[str],
    notes: Iterable[Message],
    meshes: Mapping[str, Floats] = MappingProxyType({}),
    **more: Any,
) -> Solid:
    """A robot that can be turned.

    Args:
        numbers, meshes: as of `_shapes`.
        lost: links that have no place.
        notes: what there is to see, for who cannot.
        more: other attributes.
    """
    made, left_out = _shapes(model, numbers, meshes)
    name = name_of(model.name)
    parts = [
        msg(
            "The robot {name} with {n:,} link: {links}",
            "The robot {name} with {n:,} links: {links}",
            n=len(model.links),
            name=name,
            links=named(list(model.links)),
        ),
        *notes,
    ]
    if left_out:
        parts.append(msg("not drawn: {names}", names=named(left_out)))
    return Solid(
        msg("The robot {name}", name=name),
        joined(parts, msg("; ")),
        tuple(frames),
        made,
        lost=tuple(map(name_of, lost)),
        left_out=left_out,
        **more,
    )


def placing(frame: Floats) -> Placing:
    """A transform as a place and a turn."""
    return Placing(translation(frame), quaternion(frame))


def transform(at: Sequence[float], turned: Sequence[float]) -> Floats:
    """A place and a turn as 4 x 4; a quaternion of another length than 1 turns as that would."""
    x, y, z, w = np.array(turned) / np.sqrt(np.square(turned).sum())
    frame = np.eye(4)
    frame[:3, :3] = (
        (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
    )
    frame[:3, 3] = at
    return frame


def is_finite(values: Sequence[float]) -> bool:
    """Whether all are numbers of a size that things have."""
    return all(abs(value) < _FARTHEST for value in values)


def name_of(name: str) -> str:
    """A name of the submission's, as it may stand in a page."""
    return shown(name, LONGEST_NAME)


def named(names: Sequence[str], most: int = 6) -> Message:
    return listed(map(name_of, names), most)


def descend(
    start: str, children: Mapping[str, Sequence[str]], seen: set[str]
) -> Iterator[tuple[int, str]]:
    """What hangs on what, from a start down, with its depth; what was seen is left out."""
    waiting = [(0, start)]
    while waiting:
        depth, name = waiting.pop()
        if name not in seen:
            seen.add(name)
            yield depth, name
            waiting += [(depth + 1, each) for each in reversed(children.get(name, ()))]


_KINDS = {"Box": "box", "Cylinder": "cylinder", "Sphere": "sphere"}


def _sizes(shape: Geometry, meshes: Mapping[str, Floats]) -> tuple[float, ...]:
    """As in `Shape`; () where there is nothing to draw."""
    if isinstance(shape, Box):
        return shape.size
    if isinstance(shape, Cylinder):
        return shape.radius, shape.length
    if isinstance(shape, Sphere):
        return (shape.radius,)
    corners = meshes.get(shape.filename)
    if corners is None:
        return ()
    return tuple((corners * np.array(shape.scale)).ravel().tolist())


def _colour(visual: Visual) -> Colour:
    if visual.material is None:
        return _RED
    return _WHITE if visual.material.texture else visual.material.rgba


def _hex(colour: Colour) -> str:
    red, green, blue = (round(255 * part) for part in colour[:3])
    return f"#{red:02x}{green:02x}{blue:02x}"
