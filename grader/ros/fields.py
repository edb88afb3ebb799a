"""Parses the lines of .msg, .srv and .action as names and types; needs no ROS.

Values are not understood, and mistakes not told: `definitions` does both, by ROS's own parser.
"""

from __future__ import annotations

import re
from typing import Final, NamedTuple

#: A type with its bounds, a name, and of a constant its value.
_LINE: Final = re.compile(
    r"([A-Za-z][\w/]*)(?:<=(\d{1,18}))?(\[(?:<=)?(\d{0,18})\])?"
    r"[ \t]+([A-Za-z]\w*)[ \t]*(?:=[ \t]*(.*))?"
)


class Field(NamedTuple):
    """A field or a constant of a message.

    Attributes:
        base: its type without bounds: 'float64', 'Num', 'geometry_msgs/Point'.
        longest: the bound of a string; 0 for none.
        array: '', '[]', '[3]' or '[<=3]'.
        size: that number; 0 for none.
        value: a constant's, as it stands there; None for a field.
    """

    name: str
    base: str
    longest: int = 0
    array: str = ""
    size: int = 0
    value: str | None = None

    @property
    def type(self) -> str:
        """The type with its bounds: 'string<=5[]'."""
        return f"{self.base}{f'<={self.longest}' if self.longest else ''}{self.array}"

    @property
    def package(self) -> str:
        """The package that its type names; '' for none."""
        return self.base.rpartition("/")[0].partition("/")[0]


def lines(text: str) -> list[Field | str]:
    """Return the lines of a definition without comments; what is no field as it stands, as ---."""
    found = filter(None, (line.partition("#")[0].strip() for line in text.splitlines()))
    return [_field(line) or line for line in found]


def parse(text: str) -> list[list[Field]]:
    """Parse a definition: the fields and constants of a message, or of each part.

    Raises:
        ValueError: a line is no such one.
    """
    parts: list[list[Field]] = [[]]
    for line in lines(text):
        if isinstance(line, Field):
            parts[-1].append(line)
        elif line == "---":
            parts.append([])
        else:
            raise ValueError(f"expected a type and a name, found {line!r:.80}")
    return parts


def readable(text: str) -> list[Field]:
    """Return what can be read of a definition that may have any mistake."""
    return [line for line in lines(text) if isinstance(line, Field)]


def field_lines(text: str) -> list[str]:
    """Return the fields of a definition as 'float64 x', and whatever else stands in its lines."""
    return [
        f"{line.type} {line.name}" if isinstance(line, Field) else line
        for line in lines(text)
        if isinstance(line, str) or line.value is None
    ]


def _field(line: str) -> Field | None:
    if (found := _LINE.match(line)) is None:
        return None
    base, longest, array, size, name, value = found.groups()
    return Field(name, base, int(longest or 0), array or "", int(size or 0), value)
