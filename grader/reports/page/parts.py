"""The parts of a view for a page: trees as rows, solids that can be turned."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from grader.recording.view import Placing, Shape, Solid, Tree, TreeNode
from grader.text import strings as text
from grader.text.translations import tr, translate

#: The drawing's width, a row's height, the indent of a level [px], the deepest indented level.
WIDTH, ROW, STEP, DEEPEST = 360, 38, 18, 8
_LEFT, _DOT = 9, 16
#: The width of a letter [px], in bold and in small type.
_NAME_PX, _TEXT_PX = 8.2, 6.2
_MOST_WORDS = 40


@dataclass(frozen=True)
class DrawnNode:
    """A node in its place.

    Attributes:
        x, y: of its dot [px].
        name, text: clipped to the width.
        full: both in full.
        mark: as in `TreeNode`.
        path: the `d` of an SVG path to its parent; '' for none.
    """

    x: int
    y: int
    name: str
    text: str
    full: str
    mark: str
    path: str


@dataclass(frozen=True)
class DrawnTree:
    """A tree with the places of its nodes.

    Attributes:
        height: [px].
        words: the tree as text, for screen readers.
    """

    tree: Tree
    nodes: tuple[DrawnNode, ...]
    height: int
    words: str


def drawn(tree: Tree) -> DrawnTree:
    nodes: list[DrawnNode] = []
    last: dict[int, tuple[int, int]] = {}  # by depth, the dot of the node above
    for row, node in enumerate(tree.nodes):
        depth = min(node.depth, DEEPEST)
        x, y = _LEFT + STEP * depth, _DOT + ROW * row
        path = ""
        if node.depth and node.depth - 1 in last:
            above_x, above_y = last[node.depth - 1]
            path = f"M{above_x} {above_y + 6}V{y}H{x - 6}" if above_x < x else ""
        last[node.depth] = x, y
        nodes.append(_node(node, x, y, path))
    words = "; ".join(_words(node) for node in tree.nodes[:_MOST_WORDS])
    return DrawnTree(tree, tuple(nodes), _DOT + ROW * len(nodes), words)


def _node(node: TreeNode, x: int, y: int, path: str) -> DrawnNode:
    room, description = WIDTH - x - 12, translate(node.text)
    return DrawnNode(
        *(x, y),
        text.clip(node.name, int(room / _NAME_PX)),
        text.clip(description, int(room / _TEXT_PX)),
        tr("{name}: {text}", name=node.name, text=description),
        node.mark,
        path,
    )


def _words(node: TreeNode) -> str:
    values = {"name": "- " * node.depth + node.name, "text": translate(node.text)}
    if node.mark == "lost":
        return tr("{name} (no place): {text}", **values)
    if node.mark == "wrong":
        return tr("{name} (wrong): {text}", **values)
    return tr("{name}: {text}", **values)


# Solids -----------------------------------------------------------------------------------------

#: Kept decimals: of a place [m], of a quaternion, of a size [m].
_PLACE, _TURN, _SIZE = 4, 4, 5
_KINDS = {"box": 0, "cylinder": 1, "sphere": 2, "triangles": 3}


@dataclass(frozen=True)
class Turnable:
    """A solid in a page.

    Attributes:
        solid: its frames and shapes.
        data: for the script: `t` the times [s], `frames` each its parent and placings, `shapes`
            each its kind, frame, placing, sizes, colour and alpha, `ground` and `way`.
    """

    solid: Solid
    data: dict[str, Any]


def turnable(solid: Solid) -> Turnable:
    data = {
        "t": [round(time_ns / 1e9, 2) for time_ns in solid.times_ns],
        "frames": [
            [frame.parent, [_placing(each) for each in frame.placings]] for frame in solid.frames
        ],
        "shapes": [_shape(each) for each in solid.shapes],
        "ground": None if solid.ground_m is None else round(solid.ground_m, _PLACE),
        "way": solid.way.round(3).tolist(),
    }
    return Turnable(solid, data)


def _shape(shape: Shape) -> list[Any]:
    sizes = [round(size, _SIZE) for size in shape.sizes]
    placing = _placing(shape.placing)
    return [_KINDS[shape.kind], shape.frame, placing, sizes, shape.color, round(shape.alpha, 2)]


def _placing(placing: Placing | None) -> list[float] | None:
    if placing is None:
        return None
    at = [round(value, _PLACE) + 0.0 for value in placing.at]
    return [*at, *(round(value, _TURN) + 0.0 for value in placing.turned)]
