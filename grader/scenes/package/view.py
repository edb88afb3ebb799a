"""A package for people: the links of its robot as a tree in a picture, and remarks."""

from __future__ import annotations

from typing import Final
from xml.etree import ElementTree

import numpy as np

from grader.scenes.package.trace import PackageTrace
from grader.scenes.view import Pixels, Plane, View

SIZE_PX: Final = 500
PLANE: Final = Plane(SIZE_PX, 1.0, float(SIZE_PX))
_MOST_LINES, _LINE_PX, _INDENT_PX = 40, 12, 14
_LONGEST_TEXT = 200_000


def view() -> View:
    """Nothing moves."""
    return View((), (), "#ffffff", None, (), ())


def picture(trace: PackageTrace) -> Pixels:
    """The tree of links, uint8 array (500, 500, 3)."""
    from PIL import Image, ImageDraw  # here: what judges draws nothing

    image = Image.new("RGB", (SIZE_PX, SIZE_PX), "white")
    draw = ImageDraw.Draw(image)
    for number, (depth, line) in enumerate(_lines(trace)[:_MOST_LINES]):
        place = (10 + _INDENT_PX * depth, 8 + _LINE_PX * number)
        draw.text(place, line.encode("ascii", "replace").decode()[:70], "black")
    return np.asarray(image, dtype=np.uint8).copy()


def remarks(trace: PackageTrace) -> list[str]:
    """What a reader of the result should know."""
    if trace.setup is None:
        return []
    found = [
        f"{launch.file} could not be evaluated: {launch.problem.text}"
        for launch in trace.launches
        if launch.problem is not None and launch.problem.kind == "unknown"
    ]
    found += [f"{launch.file}: {remark}" for launch in trace.launches for remark in launch.remarks]
    if trace.others:
        beside = ", ".join(trace.others[:10])
        found.append(f"judged was the package {trace.setup.name}; beside it lie {beside}")
    return found


def _lines(trace: PackageTrace) -> list[tuple[int, str]]:
    if not trace.descriptions or trace.descriptions[0].text < 0:
        return [(0, "no robot description was found")]
    text = trace.texts[trace.descriptions[0].text]
    children: dict[str, list[tuple[str, str]]] = {}
    links: list[str] = []
    try:
        if len(text) > _LONGEST_TEXT or "<!DOCTYPE" in text:
            raise ValueError("too long")
        for each in ElementTree.fromstring(text):
            if each.tag == "link":
                links.append(each.get("name") or "?")
            elif each.tag == "joint":
                parent, child = each.find("parent"), each.find("child")
                if parent is not None and child is not None:
                    told = (child.get("link") or "?", f"{each.get('name')}, {each.get('type')}")
                    children.setdefault(parent.get("link") or "?", []).append(told)
    except (ElementTree.ParseError, ValueError):
        return [(0, "the robot description cannot be drawn")]
    below = {name for each in children.values() for name, _ in each}
    lines: list[tuple[int, str]] = []
    pending = [(0, name, "") for name in reversed(links) if name not in below]
    seen: set[str] = set()
    while pending and len(lines) < _MOST_LINES:
        depth, name, joint = pending.pop()
        lines.append((depth, f"{name}  ({joint})" if joint else name))
        if name not in seen:
            seen.add(name)
            pending += [(depth + 1, *each) for each in reversed(children.get(name, []))]
    return lines
