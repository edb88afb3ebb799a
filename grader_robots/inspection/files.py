"""Robot descriptions: the files that they name, and what happens where their numbers change."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import Final

from grader.submission import Workspace, begin, package_trace, safe_files, steps
from grader_robots.robot_py import tinyxml
from grader_robots.robot_py.unexpanded import unexpanded

_MOST_FILES: Final = 500
#: So many numbers of a xacro are doubled, in files that are no longer than this [characters].
_MOST_NUMBERS: Final = 60
_LONGEST_TEXT: Final = 400_000
_MOST_VARIED: Final = 4_000_000
#: A number, or `${...}` with an expression.
_NUMBER: Final = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|\$\{[^${}\"']*\}"
_GIVEN: Final = (
    r"""<xacro:{}\b(?=[^>]*\bname\s*=\s*["'](?P<name>\w+)["'])"""
    r"""[^>]*\b{}\s*=\s*["']\s*(?P<value>""" + _NUMBER + r""")\s*["']"""
)
_PROPERTY: Final = re.compile(_GIVEN.replace("{}", "property", 1).replace("{}", "value", 1))
_ARGUMENT: Final = re.compile(_GIVEN.replace("{}", "arg", 1).replace("{}", "default", 1))


def named_meshes(text: str, place: Workspace) -> tuple[package_trace.NamedMesh, ...] | None:
    """The files that a description names; None where urdfdom could not read it."""
    try:
        document = tinyxml.read(text)
    except tinyxml.Malformed:
        return None
    found: dict[tuple[str, bool], package_trace.NamedMesh] = {}
    for element in document.walk():
        if element.name in ("mesh", "texture") and (uri := element.get("filename")):
            key = uri, element.name == "mesh"
            if key not in found and len(found) < _MOST_FILES:
                state, path = _resolved(uri.strip(), place)
                named, at = place.shown(uri)[:1000], place.shown(path)[:1000]
                found[key] = package_trace.NamedMesh(named, state, at, key[1])
    return tuple(found.values())


def _resolved(uri: str, place: Workspace) -> tuple[str, str]:
    if uri.startswith("package://"):
        package, _, inside = uri.removeprefix("package://").partition("/")
        one = next((each for each in place.all if each.name == package), None)
        if one is None:
            return ("foreign" if place.knows(package) else "package"), package
        return _looked_for(
            Path(os.path.normpath(f"{place.prefix}/share/{package}/{inside}")), place
        )
    if uri.startswith("file:///"):
        path = Path(os.path.normpath(uri.removeprefix("file://")))
        if path.is_relative_to(place.stubs):
            return "foreign", str(path)
        return _looked_for(path, place)
    return "scheme", uri.removeprefix("file://")


def _looked_for(path: Path, place: Workspace) -> tuple[str, str]:
    """What there is of a file of ours, by a path without `..`."""
    if not path.is_relative_to(place.prefix):
        return "missing", str(path)
    if safe_files.is_file(path):
        return "found", str(path)
    meant = place.own(place.meant(str(path)))
    if meant and str(path).endswith(f"/{meant}"):
        return "left", meant
    if not meant:
        for each in place.all:
            for file in each.package.files:
                if os.path.basename(file).lower() == path.name.lower():
                    return "case", file
    return "missing", str(path)


def expanded(place: Workspace) -> list[dict[str, str]]:
    """In a copy of the process: the descriptions in the package's files, expanded.

    For packages whose launch files hand none to a robot_state_publisher.
    """
    record = begin(place)
    made: list[dict[str, str]] = []
    sources = {source: path for path, source in place.judged.files.items()}
    for file in place.judged.package.descriptions:
        if len(made) >= 5:
            break
        path = place.prefix / sources[file] if file in sources else None
        path = path or place.judged.package.folder / file
        text = path.read_text(encoding="utf-8", errors="replace")
        if not re.search(r"<robot\b[^>]*\bname\s*=", text):
            continue  # a part that another file includes
        code, errors = 0, ""
        if file.endswith(".xacro") or unexpanded(text):
            code, text, errors = record.xacro([str(path)])
        made.append(
            {"file": file, "text": "" if code else text, "errors": steps.end_of(errors, 1000)}
        )
    return made


def varied(place: Workspace, source: str) -> list[dict[str, str]]:
    """In a copy of the process: a xacro with one of its numbers doubled, for each of them.

    Args:
        source: the xacro file, where it is laid out.
    """
    record = begin(place)
    found: list[dict[str, str]] = []
    size = 0
    share = place.prefix / "share"
    if Path(source).is_relative_to(share):  # setup.py may call the package by another name
        share /= Path(source).relative_to(share).parts[0]
    folder = place.judged.package.folder
    own = sorted(folder / file for file in place.judged.package.files)
    # what is not installed is read where it lies in the package
    for path in own if source.startswith(f"{folder}/") else sorted(share.rglob("*")):
        if path.suffix not in (".xacro", ".urdf", ".xml") or not path.is_file():
            continue
        text = path.read_text(encoding="utf-8", errors="replace")
        if len(text) > _LONGEST_TEXT:
            continue
        for match in (*_PROPERTY.finditer(text), *_ARGUMENT.finditer(text)):
            if len(found) >= _MOST_NUMBERS or size > _MOST_VARIED:
                return found
            value = match["value"].removeprefix("${").removesuffix("}")
            doubled = f"${{2 * ({value})}}" if value != match["value"] else repr(2 * float(value))
            other = f"{text[: match.start('value')]}{doubled}{text[match.end('value') :]}"
            path.write_text(other, encoding="utf-8")
            code, made, _ = record.xacro([source])
            path.write_text(text, encoding="utf-8")
            size += len(made)
            found.append({"name": match["name"], "text": "" if code else place.shown(made)})
    return found
