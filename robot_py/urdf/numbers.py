"""Numbers and vectors as urdfdom reads them: a comma, a line break or a unit is no number."""

from __future__ import annotations

import math
import re

from robot_py.findings import Malformed
from robot_py.model import Pose, Vector
from robot_py.urdf.tinyxml import Element

#: A C++ stream skips blanks before a number; nothing may stand behind it.
NUMBER = re.compile(r"[ \t\n\v\f\r]*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)")


def number(text: str) -> float:
    """The number that a text is.

    Raises:
        ValueError: it is none, or too large for a double.
    """
    match = NUMBER.fullmatch(text)
    if match is None or math.isinf(value := float(match[1])):
        raise ValueError(text)
    return value


def attribute(element: Element, name: str, default: float | None, missing: str = "") -> float:
    """A number among an element's attributes; `missing` is said where there is no default for it.

    Raises:
        Malformed: it is not there, or no number.
    """
    text = element.get(name)
    if text is None:
        if default is None:
            raise Malformed(missing, line=element.line)
        return default
    try:
        return number(text)
    except ValueError:
        raise Malformed(f"{name} value ({text}) is not a valid float", line=element.line) from None


def vector(text: str, line: int) -> Vector:
    """Three numbers with blanks between them.

    Raises:
        Malformed: they are not.
    """
    values = []
    for piece in filter(None, text.split(" ")):
        try:
            values.append(number(piece))
        except ValueError:
            why = f"Unable to parse component [{piece}] to a double (while parsing a vector value)"
            raise Malformed(why, line=line) from None
    if len(values) != 3:
        why = f"Parser found {len(values)} elements but 3 expected while parsing vector [{text}]"
        raise Malformed(why, line=line)
    x, y, z = values
    return x, y, z


def pose(parent: Element) -> Pose:
    """What an element's <origin> says; no turn and no move where there is none.

    Raises:
        Malformed: one of its vectors is none.
    """
    origin = parent.first("origin")
    if origin is None:
        return Pose()
    zero = "0 0 0"
    return Pose(
        vector(origin.attributes.get("xyz", zero), origin.line),
        vector(origin.attributes.get("rpy", zero), origin.line),
    )
