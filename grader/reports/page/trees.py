"""A tree as a drawing: a row for each node, and lines from what hangs to what it hangs on."""

from __future__ import annotations

from dataclasses import dataclass

from grader import text
from grader.language.telling import in_language, tell
from grader.scenes.view import Tree, TreeNode

#: The drawing's width, a row's height, a step to the right [px]; deeper ones stay where they are.
WIDTH, ROW, STEP, DEEPEST = 360, 38, 18, 8
_LEFT, _DOT = 9, 16
#: So many letters there are room for, in bold and in small ones.
_NAME_PX, _TEXT_PX = 8.2, 6.2
_MOST_WORDS = 40


@dataclass(frozen=True)
class DrawnNode:
    """A node in its place.

    Attributes:
        x, y: of its dot [px].
        name, text: as far as there is room.
        full: all that it says.
        mark: as in `TreeNode`.
        path: the `d` of an SVG path to what it hangs on; '' for none.
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
    """A tree in its places.

    Attributes:
        height: [px].
        words: the tree for who cannot see it.
    """

    tree: Tree
    nodes: tuple[DrawnNode, ...]
    height: int
    words: str


def drawn(tree: Tree) -> DrawnTree:
    """Where everything of a tree is."""
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
    room, said = WIDTH - x - 12, in_language(node.text)
    return DrawnNode(
        *(x, y),
        text.clip(node.name, int(room / _NAME_PX)),
        text.clip(said, int(room / _TEXT_PX)),
        tell("{name}: {text}", name=node.name, text=said),
        node.mark,
        path,
    )


def _words(node: TreeNode) -> str:
    said = {"name": "- " * node.depth + node.name, "text": in_language(node.text)}
    if node.mark == "lost":
        return tell("{name} (no place): {text}", **said)
    if node.mark == "wrong":
        return tell("{name} (wrong): {text}", **said)
    return tell("{name}: {text}", **said)
