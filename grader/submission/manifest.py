"""Reads a package.xml as far as colcon does: whether it is a ROS package, its name, its build type.

Files of a starter name their exercise, whatever becomes of their own names: a package.xml by an
element that colcon ignores, a Python file that is in no package by a comment.

The required elements are those of catkin_pkg, which colcon parses it with (`package.py`:
`parse_package`, `PackageFolder.validate`).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from grader.submission.folder import read_bounded
from grader.text.message import NOTHING, Message, msg
from grader.text.strings import shown

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

FILE: Final = "package.xml"

_REQUIRED: Final = ("name", "version", "description", "maintainer", "license")
_NAME: Final = re.compile(r"[a-zA-Z0-9][a-zA-Z0-9_-]*")
#: What names an exercise in a package.xml, and in a Python file.
_ELEMENT: Final = '<grader exercise="{exercise}"/>'
_COMMENT: Final = "# grader: exercise={exercise}"
_COMMENTED: Final = re.compile(rb"^# grader: exercise=(\S+)\s*$", re.MULTILINE)
#: So much of a Python file is searched for it [bytes].
_BEGINNING: Final = 2000
_VERSION: Final = re.compile(r"[0-9]+\.[0-9]+\.[0-9]+")


class _HasDoctype(Exception):
    """An XML file with more than elements."""


@dataclass(frozen=True)
class Manifest:
    """The content of a package.xml.

    Attributes:
        name: of the package; '' where it has none that can be used.
        build_type: "ament_python"; '' where it has none, None where it depends on a condition.
        fault: why it is no ROS package for colcon, as what follows the file's name; '' where it
            is one.
        exercises: those that it names.
        elements: those with a text: ("depend", "rclpy").
    """

    name: str
    build_type: str | None
    fault: Message
    exercises: tuple[str, ...] = ()
    elements: tuple[tuple[str, str], ...] = ()

    @property
    def depends(self) -> set[str]:
        """The packages that it depends on."""
        return {text for tag, text in self.elements if tag.endswith("depend")}


def read_manifest(file: Path) -> Manifest | None:
    """Read a package.xml; None where it is too large, or declares entities, to be read here."""
    data = read_bounded(file)
    if data is None:
        return None
    root = parse_xml(data)
    if root is None or isinstance(root, Message):
        return None if root is None else Manifest("", "", root)
    name = (root.findtext("name") or "").strip()
    types = root.findall("export/build_type")
    conditional = any(node.attrib for node in types)
    build_type = None if conditional else "".join((types[0].text or "").split()) if types else ""
    named = (node.get("exercise", "").strip() for node in root.findall("export/grader"))
    elements = tuple((node.tag, node.text.strip()) for node in root if node.text)
    return Manifest(name, build_type, _fault(root, name), tuple(filter(None, named)), elements)


def exercises_named(file: Path) -> tuple[str, ...]:
    """Return the exercises that a package.xml or a Python file names."""
    if file.name == FILE:
        manifest = read_manifest(file)
        return manifest.exercises if manifest else ()
    with file.open("rb") as source:
        found = _COMMENTED.findall(source.read(_BEGINNING))
    return tuple(each.decode("utf-8", "replace") for each in found)


def naming(text: str, exercise: str, *, is_manifest: bool) -> str:
    """Return the text of a package.xml or a Python file, which names an exercise now."""
    if not is_manifest:
        begin = re.match(r"\ufeff?(#!.*\n)?(#.*coding.*\n)?", text)
        at = begin.end() if begin else 0
        return f"{text[:at]}{_COMMENT.format(exercise=exercise)}\n{text[at:]}"
    element = _ELEMENT.format(exercise=exercise)
    before, end, after = text.rpartition("</export>")
    if end:
        return f"{before}  {element}\n  {end}{after}"
    before, end, after = text.rpartition("</package>")
    return f"{before}  <export>\n    {element}\n  </export>\n{end}{after}"


def parse_xml(data: bytes) -> Element | Message | None:
    """Parse XML: its root; or why it does not parse; or None where it has a DOCTYPE.

    That may declare entities, which make a long text out of a short one; nothing of ROS needs it.
    """
    from xml.etree import ElementTree  # here: many submissions have none

    class Builder(ElementTree.TreeBuilder):
        def doctype(self, *_: object) -> None:
            raise _HasDoctype

    try:
        return ElementTree.fromstring(data, ElementTree.XMLParser(target=Builder()))
    except _HasDoctype:
        return None
    except ElementTree.ParseError as error:
        line, _ = error.position
        if (tag := _left_open(data)) is not None:
            return msg(
                "does not parse: <{tag}> of line {line} is not closed", tag=tag[0], line=tag[1]
            )
        return msg(
            "does not parse, line {line}: {found}",
            line=line,
            found=shown(str(error).partition(":")[0]),
        )
    except (ValueError, LookupError) as error:  # its encoding
        return msg("does not parse: {found}", found=shown(str(error)))


def _left_open(data: bytes) -> tuple[str, int] | None:
    """Return the tag that is open where a text without DOCTYPE ends to be XML, and its line."""
    from xml.parsers import expat

    parser, tags = expat.ParserCreate(), list[tuple[str, int]]()
    parser.StartElementHandler = lambda tag, _: tags.append((shown(tag), parser.CurrentLineNumber))
    parser.EndElementHandler = lambda _: tags.pop()
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        codes = ("XML_ERROR_TAG_MISMATCH", "XML_ERROR_NO_ELEMENTS")
        is_open = error.code in [expat.errors.codes[getattr(expat.errors, each)] for each in codes]
        return tags[-1] if tags and is_open else None
    return None


def _fault(root: Element, name: str) -> Message:
    if root.tag != "package":
        return msg("begins with <{found}>; expected <package>", found=shown(root.tag))
    for tag in _REQUIRED:
        nodes = root.findall(tag)
        if not nodes or not any("".join(node.itertext()).strip() for node in nodes):
            return msg("has no <{tag}>", tag=tag)
    if not _NAME.fullmatch(name):
        return msg("names the package {found}; expected letters, digits and _", found=shown(name))
    version = (root.findtext("version") or "").strip()
    if not _VERSION.fullmatch(version):
        return msg(
            "has the version {found}; expected three numbers, as 0.1.0", found=shown(version)
        )
    if not all(node.get("email") for node in root.findall("maintainer")):
        return msg('has a <maintainer> without email="..."')
    return NOTHING
