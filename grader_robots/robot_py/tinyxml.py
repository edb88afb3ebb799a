"""Reads XML the way tinyxml2, and so urdfdom, reads it, which is not quite XML.

No XML parser of Python's can stand in: line breaks within an attribute stay (in XML they become
blanks, and a vector over two lines would be right), `--` in a comment is fine, prefixes mean
nothing, text after the end is refused only sometimes. What it does not know makes it safe for files
of strangers: a document type is skipped, nothing is ever expanded but the five named characters and
numbered ones, nothing is loaded, and depth is bounded. Time and memory grow with the length only.

An `Element` reads its attributes as urdfdom does: a comma, a line break or a unit is no number.
A fault is a `Malformed` in the words of tinyxml2 or urdfdom.
"""

from __future__ import annotations

import math
import re
from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, field
from enum import Enum, StrEnum
from typing import NoReturn

from grader_robots.robot_py.model import Origin, Vector

#: So many elements may not lie within each other; tinyxml2's, which counts the document.
TOO_DEEP = 500

SPACE = r"[ \t\n\v\f\r]*"
NAME = "[A-Za-z_:\x80-\U0010ffff][A-Za-z0-9_:.\x80-\U0010ffff-]*"
BLANKS = re.compile(SPACE)
ELEMENT_START = re.compile(f"{SPACE}(/?)({NAME})")
ATTRIBUTE = re.compile(f"({NAME}){SPACE}={SPACE}(?:\"([^\"]*)\"|'([^']*)')")
NAME_START = re.compile("[A-Za-z_:\x80-\U0010ffff]")
LINE_END = re.compile("\r\n|\n\r|\r")
REFERENCE = re.compile("&(?:(quot|amp|apos|lt|gt)|#x([0-9a-fA-F]+)|#([0-9]+));")
NAMED = {"quot": '"', "amp": "&", "apos": "'", "lt": "<", "gt": ">"}
#: A C++ stream skips blanks before a number; nothing may stand behind it. Nothing is tried twice
#: (`++`): a million digits and a letter would else need hours.
NUMBER = re.compile(
    r"[ \t\n\v\f\r]*+([+-]?(?:[0-9]++(?:\.[0-9]*+)?|\.[0-9]++)(?:[eE][+-]?[0-9]++)?)"
)


class Trouble(Enum):
    """tinyxml2's errors: name and number."""

    XML_ERROR_PARSING_ELEMENT = 6
    XML_ERROR_PARSING_ATTRIBUTE = 7
    XML_ERROR_PARSING_TEXT = 8
    XML_ERROR_PARSING_CDATA = 9
    XML_ERROR_PARSING_COMMENT = 10
    XML_ERROR_PARSING_DECLARATION = 11
    XML_ERROR_PARSING_UNKNOWN = 12
    XML_ERROR_EMPTY_DOCUMENT = 13
    XML_ERROR_MISMATCHED_ELEMENT = 14
    XML_ERROR_PARSING = 15
    XML_ELEMENT_DEPTH_EXCEEDED = 18


#: What is no element: how it begins, how it ends, and what is wrong where it does not end.
PASSED_OVER = (
    ("<?", "?>", Trouble.XML_ERROR_PARSING_DECLARATION),
    ("<!--", "-->", Trouble.XML_ERROR_PARSING_COMMENT),
    ("<![CDATA[", "]]>", Trouble.XML_ERROR_PARSING_CDATA),
    ("<!", ">", Trouble.XML_ERROR_PARSING_UNKNOWN),
)


class Consequence(StrEnum):
    """The effect of a finding on the robot."""

    #: There is no robot: robot_state_publisher ends, or refuses the change.
    REFUSED = "refused"
    #: An `Error:` line, yet a robot: it goes without the rest of that link, or that colour.
    DROPPED = "dropped"
    #: Nothing is left out.
    WARNED = "warned"


@dataclass(frozen=True, slots=True)
class UrdfFinding:
    """A line that urdfdom prints.

    Attributes:
        text: without the `Error:` or `Warning:` that stands before it.
        line: of the element that it is about, in the file, from 1; 0 where it is about the whole.
    """

    consequence: Consequence
    text: str
    line: int = 0

    def __str__(self) -> str:
        """Format as console_bridge, without its second line, which names a place in urdfdom."""
        prefix = "Warning: " if self.consequence is Consequence.WARNED else "Error:   "
        return prefix + self.text


class Malformed(ValueError):
    """A part of a URDF that urdfdom gives up: the lines that it prints, innermost first."""

    def __init__(self, *texts: str, line: int = 0) -> None:
        super().__init__(*texts)
        self.texts = texts
        self.line = line

    def within(self, text: str) -> Malformed:
        """Return the fault with the line that the surrounding part adds."""
        return Malformed(*self.texts, text, line=self.line)

    def findings(self, consequence: Consequence) -> list[UrdfFinding]:
        """Return a finding for each line."""
        return [UrdfFinding(consequence, text, self.line) for text in self.texts]


@dataclass(slots=True)
class Element:
    """An element, without its text, which URDF has no use for.

    Attributes:
        line: where it begins, from 1.
    """

    name: str
    line: int
    attributes: dict[str, str] = field(default_factory=dict)
    children: list[Element] = field(default_factory=list)

    def first(self, name: str) -> Element | None:
        """Return the first child of that name."""
        return next(self.all(name), None)

    def all(self, name: str) -> Iterator[Element]:
        """Return all children of that name."""
        return (child for child in self.children if child.name == name)

    def walk(self) -> Iterator[Element]:
        """Yield the element and all within it, in their order."""
        waiting = [self]
        while waiting:
            yield (element := waiting.pop())
            waiting += reversed(element.children)

    def get(self, attribute: str) -> str | None:
        """Return an attribute's value; None where it is not given."""
        return self.attributes.get(attribute)

    def malformed(self, *texts: str) -> Malformed:
        """Return the fault of this element."""
        return Malformed(*texts, line=self.line)

    def needed(self, attribute: str, missing: str) -> str:
        """Return an attribute's value; `Malformed` with the text `missing` where it is absent."""
        if attribute not in self.attributes:
            raise self.malformed(missing)
        return self.attributes[attribute]

    def number(self, text: str, wrong: str) -> float:
        """Return a number; `Malformed` with the text `wrong` where it is none."""
        match = NUMBER.fullmatch(text)
        if match is None or math.isinf(value := float(match[1])):
            raise self.malformed(wrong)
        return value

    def vector(self, text: str) -> Vector:
        """Return three numbers with blanks between them; `Malformed` where they are not."""
        of = "to a double (while parsing a vector value)"
        pieces = list(filter(None, text.split(" ")))
        values = [
            self.number(piece, f"Unable to parse component [{piece}] {of}") for piece in pieces
        ]
        if len(values) != 3:
            found = f"{len(values)} elements but 3 expected while parsing vector [{text}]"
            raise self.malformed(f"Parser found {found}")
        x, y, z = values
        return x, y, z

    def origin(self) -> Origin:
        """Return what the child <origin> describes; no turn and no move where there is none."""
        origin = self.first("origin")
        if origin is None:
            return Origin()
        xyz, rpy = (origin.vector(origin.attributes.get(name, "0 0 0")) for name in ("xyz", "rpy"))
        return Origin(xyz, rpy)


def read(text: str) -> Element:
    """Return the document: an element without a name, whose children are its outermost elements.

    Raises:
        Malformed: with tinyxml2's complaint.
    """
    # to urdfdom the text is a C string
    return _XmlReader(text.partition("\0")[0]).document()


class _XmlReader:
    """Goes once through the text; `_at` is how far it has come."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._at = 0
        self._line_ends = [match.start() for match in re.finditer("\n", text)]
        self._open = [Element("", 1)]
        #: what stands at the top so far: only declarations may stand before a declaration
        self._only_declarations = True

    def document(self) -> Element:
        self._skip_blanks()
        if self._at_end():
            self._refuse(Trouble.XML_ERROR_EMPTY_DOCUMENT, 0)
        if self._text.startswith("\ufeff", self._at):
            self._at += 1
            self._skip_blanks()
        while not self._at_end():
            if self._text[self._at] != "<":
                self._pass_text()
            elif passed_over := next(
                (kind for kind in PASSED_OVER if self._text.startswith(kind[0], self._at)), None
            ):
                self._pass_over(*passed_over)
            elif not self._pass_tag():  # nothing behind it counts
                return self._open[0]
            self._skip_blanks()
        if len(self._open) > 1:
            self._refuse(Trouble.XML_ERROR_PARSING, self._open[-1].line)
        return self._open[0]

    def _pass_text(self) -> None:
        end = self._text.find("<", self._at)
        if end < 0:
            self._refuse(Trouble.XML_ERROR_PARSING_TEXT, self._line())
        self._at = end
        self._only_declarations = False

    def _pass_over(self, begin: str, end: str, trouble: Trouble) -> None:
        found = self._text.find(end, self._at + len(begin))
        if found < 0:
            self._refuse(trouble, self._line())
        if begin != "<?":
            self._only_declarations = False
        elif len(self._open) > 1 or not self._only_declarations:
            value = self._text[self._at + len(begin) : found]
            self._refuse(trouble, self._line(), f"XMLDeclaration value={value}")
        self._at = found + len(end)

    def _pass_tag(self) -> bool:
        line = self._line()
        start = ELEMENT_START.match(self._text, self._at + 1)
        if start is None:
            self._refuse(Trouble.XML_ERROR_PARSING, line)
        self._only_declarations = False
        self._at = start.end()
        element = Element(start[2], line)
        closed_itself = self._read_attributes(element)
        if start[1] and not closed_itself:
            return self._close(element.name)
        if closed_itself:
            self._open[-1].children.append(element)
        else:
            self._open.append(element)
            if len(self._open) == TOO_DEEP:
                why = "Element nesting is too deep."
                self._refuse(Trouble.XML_ELEMENT_DEPTH_EXCEEDED, self._line(), why)
        return True

    def _close(self, name: str) -> bool:
        if len(self._open) == 1:
            return False  # nothing is open: for tinyxml2 this is the end
        element = self._open.pop()
        if element.name != name:
            where = f"XMLElement name={element.name}"
            self._refuse(Trouble.XML_ERROR_MISMATCHED_ELEMENT, element.line, where)
        self._open[-1].children.append(element)
        return True

    def _read_attributes(self, element: Element) -> bool:
        """Read up to the end of the tag; return whether it closes itself."""
        while True:
            self._skip_blanks()
            if self._text.startswith("/>", self._at):
                self._at += 2
                return True
            if self._text.startswith(">", self._at):
                self._at += 1
                return False
            if self._at_end():
                where = f"XMLElement name={element.name}"
                self._refuse(Trouble.XML_ERROR_PARSING_ELEMENT, element.line, where)
            if NAME_START.match(self._text, self._at) is None:
                self._refuse(Trouble.XML_ERROR_PARSING_ELEMENT, element.line)
            attribute = ATTRIBUTE.match(self._text, self._at)
            if attribute is None or attribute[1] in element.attributes:
                where = f"XMLElement name={element.name}"
                self._refuse(Trouble.XML_ERROR_PARSING_ATTRIBUTE, self._line(), where)
            raw = attribute[2] if attribute[2] is not None else attribute[3]
            element.attributes[attribute[1]] = _meant(raw)
            self._at = attribute.end()

    def _skip_blanks(self) -> None:
        blanks = BLANKS.match(self._text, self._at)
        assert blanks is not None  # it matches nothing, too
        self._at = blanks.end()

    def _at_end(self) -> bool:
        return self._at >= len(self._text)

    def _line(self) -> int:
        return 1 + bisect_right(self._line_ends, self._at - 1)

    def _refuse(self, trouble: Trouble, line: int, details: str = "") -> NoReturn:
        number = trouble.value
        text = f"Error={trouble.name} ErrorID={number} (0x{number:x}) Line number={line}"
        raise Malformed(f"{text}: {details}" if details else text, line=line)


def _meant(raw: str) -> str:
    """Return an attribute's value with one kind of line end and without references."""
    return REFERENCE.sub(_referred, LINE_END.sub("\n", raw))


def _referred(reference: re.Match[str]) -> str:
    if name := reference[1]:
        return NAMED[name]
    number = int(reference[2], 16) if reference[2] else int(reference[3][:20])
    if number == 0 or number > 0x10FFFF or 0xD800 <= number <= 0xDFFF:
        return reference[0]
    return chr(number)
