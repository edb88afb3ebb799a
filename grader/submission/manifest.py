"""Reads a package.xml as far as colcon does: whether it is a ROS package, its name, its build type.

The required elements are those of catkin_pkg, which colcon parses it with (`package.py`:
`parse_package`, `PackageFolder.validate`).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Final

from grader.message import NOTHING, Message, msg
from grader.submission.folder import read_bounded, shown

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

FILE: Final = "package.xml"

_REQUIRED: Final = ("name", "version", "description", "maintainer", "license")
_NAME: Final = re.compile(r"[a-zA-Z0-9][a-zA-Z0-9_-]*")
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
    """

    name: str
    build_type: str | None
    fault: Message


def read_manifest(file: Path) -> Manifest | None:
    """Read a package.xml; None where it is too large, or declares entities, to be read here.

    Raises:
        OSError: it cannot be read.
    """
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
    return Manifest(name, build_type, _fault(root, name))


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
        return msg(
            "does not parse, line {line}: {found}",
            line=line,
            found=shown(str(error).partition(":")[0]),
        )
    except (ValueError, LookupError) as error:  # its encoding
        return msg("does not parse: {found}", found=shown(str(error)))


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
