"""The packages in what was handed in: where they lie, what they say of themselves."""

from __future__ import annotations

import os
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

from grader.message import NOTHING, Message, msg
from grader.submission.examining import paths
from grader.submission.examining.steps import it

MANIFEST = "package.xml"
_SKIPPED = {"build", "install", "log", "__pycache__", "venv", "env", "node_modules"}
_DEPENDS = ("depend", "exec_depend", "run_depend", "build_depend", "build_export_depend")
_REQUIRED = ("name", "version", "description", "maintainer", "license")
_MOST_BYTES, _MOST_FILES = 1_000_000, 5000
_MOST_DEPENDS, _LONGEST = 500, 500


@dataclass(frozen=True)
class SourcePackage:
    """A package.

    Attributes:
        folder: where it lies.
        name: by its package.xml; '' where that tells none.
        build_type, manifest, depends: see `grader.submission.trace.Setup`.
        files: all of it, relative to its folder, in their order.
    """

    folder: Path
    name: str = ""
    build_type: str = ""
    manifest: Message = NOTHING
    depends: tuple[str, ...] = ()
    files: tuple[str, ...] = field(default=(), repr=False)

    @property
    def is_cmake(self) -> bool:
        if self.build_type:
            return self.build_type != "ament_python"
        is_python = (self.folder / "setup.py").is_file()
        return not is_python and (self.folder / "CMakeLists.txt").is_file()

    @property
    def descriptions(self) -> list[str]:
        """Its files that may describe a robot."""
        return [each for each in self.files if is_description(each)]

    @property
    def launch_files(self) -> list[str]:
        """Its files that `ros2 launch` takes, whatever they are called."""
        return [each for each in self.files if is_launch_file(each) or self._is_one(each)]

    def _is_one(self, name: str) -> bool:
        if not name.startswith("launch/") or not name.endswith(".py"):
            return False
        with suppress(OSError):
            text = paths.read(self.folder / name, _MOST_BYTES)
            return b"def generate_launch_description" in text
        return False


def is_description(name: str) -> bool:
    """Whether a file of this name may be a URDF or a xacro."""
    return name.endswith((".urdf", ".xacro", ".urdf.xml")) or (
        name.endswith(".xml") and name.split("/")[0] in ("urdf", "robots", "xacro")
    )


def is_launch_file(name: str) -> bool:
    """Whether a file of this name is one, as `ros2 launch` completes them."""
    endings = ("launch.py", "launch.xml", "launch.yaml", "launch.yml", ".launch")
    return name.endswith(endings)


def find(root: Path) -> list[SourcePackage]:
    """All packages, in the order of their paths."""
    found: list[SourcePackage] = []
    for at, folders, files in os.walk(root):
        folders[:] = _searched(folders)
        is_one = MANIFEST in files or "setup.py" in files or "CMakeLists.txt" in files
        if is_one and not any(Path(at).is_relative_to(each.folder) for each in found):
            found.append(read(Path(at)))
    return found


def _searched(folders: list[str]) -> list[str]:
    return sorted(each for each in folders if each not in _SKIPPED and not each.startswith("."))


def read(folder: Path) -> SourcePackage:
    """What the package in a folder says of itself."""
    files = _files(folder)
    if not (folder / MANIFEST).is_file():
        return SourcePackage(folder, manifest=msg("there is none"), files=files)
    try:
        data = paths.read(folder / MANIFEST, _MOST_BYTES + 1)
        if len(data) > _MOST_BYTES or b"<!DOCTYPE" in data:
            raise ValueError("it is larger than any, or has a DOCTYPE")
        root = ElementTree.fromstring(data)
    except (OSError, ValueError, LookupError, ElementTree.ParseError) as error:
        return SourcePackage(
            folder, manifest=it(msg("does not parse: {error}", error=str(error)[:280])), files=files
        )
    name = (root.findtext("name") or "").strip()[:_LONGEST]
    lacking = [tag for tag in _REQUIRED if root.find(tag) is None]
    types = root.findall("export/build_type")
    depends = (each.text or "" for each in root if each.tag in _DEPENDS)
    named = dict.fromkeys(each.strip()[:_LONGEST] for each in depends if each)
    return SourcePackage(
        folder,
        name=name,
        build_type="".join((types[0].text or "").split())[:_LONGEST] if types else "",
        manifest=it(msg("has no <{tag}>", tag=lacking[0])) if lacking else NOTHING,
        depends=tuple(named)[:_MOST_DEPENDS],
        files=files,
    )


def judged(
    found: list[SourcePackage], asked: str, folder: Path | None = None
) -> SourcePackage | None:
    """The package that describes a robot; the one that is asked for, by its name or its folder."""
    if folder is not None:
        return next((each for each in found if each.folder == folder), None)
    if asked:
        return next((each for each in found if each.name == asked), None)

    def worth(package: SourcePackage) -> tuple[bool, bool, bool, int]:
        robots = package.descriptions
        named = package.name.endswith("_description")
        return bool(robots), bool(package.launch_files), named, len(robots)

    return max(found, key=worth, default=None)


def _files(folder: Path) -> tuple[str, ...]:
    """All but those of a package within it, of which colcon builds nothing."""
    found: list[str] = []
    is_one = (folder / MANIFEST).is_file()
    for at, folders, files in os.walk(folder):
        if is_one and MANIFEST in files and Path(at) != folder:
            folders.clear()
            continue
        folders[:] = _searched(folders)
        found += [os.path.relpath(Path(at, name), folder) for name in sorted(files)]
        if len(found) > _MOST_FILES:
            break
    return tuple(found[:_MOST_FILES])
