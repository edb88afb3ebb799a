"""The packages in what was handed in: where they lie, what they say of themselves."""

from __future__ import annotations

import os
import re
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

from grader.submission import safe_files
from grader.submission.examining.steps import it
from grader.submission.folder import MAX_SOURCE_BYTES, is_junk, is_searched
from grader.submission.manifest import FILE as MANIFEST
from grader.submission.manifest import read_manifest
from grader.text.message import NOTHING, Message, msg

_DEPENDS = ("depend", "exec_depend", "run_depend", "build_depend", "build_export_depend")
#: Names that only launch files have, and what makes one of another file that `ros2 launch` takes:
#: launch/frontend's `get_file_extensions` in launch_xml and launch_yaml, and .py.
_LAUNCH_ENDINGS: Final = ("launch.py", "launch.xml", "launch.yaml", "launch.yml", ".launch")
_OF_YAML: Final = re.compile(rb"^launch\s*:", re.MULTILINE)
_OF_LAUNCH: Final = {
    ".py": re.compile(rb"^def generate_launch_description\b", re.MULTILINE),
    # the first that is neither a declaration nor a comment
    ".xml": re.compile(
        rb"\A[^<]*+(?:(?:<\?(?:(?!\?>).)*+\?>|<!--(?:(?!-->).)*+-->)[^<]*+)*+<launch\b", re.DOTALL
    ),
    ".yaml": _OF_YAML,
    ".yml": _OF_YAML,
}
_MOST_FILES = 5000
_MOST_DEPENDS, _LONGEST = 500, 500


@dataclass(frozen=True)
class SourcePackage:
    """A package.

    Attributes:
        folder: where it lies.
        name: by its package.xml; '' where that tells none.
        build_type, manifest, depends: see `grader.submission.package_trace.Setup`.
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
        """Its launch files, whatever they are called."""
        return [each for each in self.files if is_launch_file(self.folder / each)]


def is_description(name: str) -> bool:
    """Whether a file of this name may be a URDF or a xacro."""
    return name.endswith((".urdf", ".xacro", ".urdf.xml")) or (
        name.endswith(".xml") and name.split("/")[0] in ("urdf", "robots", "xacro")
    )


def is_launch_file(file: Path) -> bool:
    """Whether `ros2 launch` takes a file, and it is one by its name or by its text."""
    if file.name.endswith(_LAUNCH_ENDINGS):
        return True
    with suppress(OSError):
        says = _OF_LAUNCH.get(file.suffix)
        return says is not None and says.search(safe_files.read(file, MAX_SOURCE_BYTES)) is not None
    return False


def find(root: Path) -> list[SourcePackage]:
    """All packages, in the order of their paths."""
    found: list[SourcePackage] = []
    for at, folders, files in os.walk(root):
        folders[:] = _searched(at, folders)
        is_one = MANIFEST in files or "setup.py" in files or "CMakeLists.txt" in files
        if is_one and not any(Path(at).is_relative_to(each.folder) for each in found):
            found.append(read(Path(at)))
    return found


def _searched(at: str, folders: list[str]) -> list[str]:
    return sorted(each for each in folders if not is_junk(each) and is_searched(Path(at, each)))


def read(folder: Path) -> SourcePackage:
    """What the package in a folder says of itself."""
    files = _files(folder)
    if not safe_files.is_file(folder / MANIFEST):
        return SourcePackage(folder, manifest=msg("there is none"), files=files)
    try:
        found = read_manifest(folder / MANIFEST)
    except OSError as error:
        why = msg("cannot be read ({error})", error=error.strerror)
        return SourcePackage(folder, manifest=it(why), files=files)
    if found is None:
        why = msg("is larger than any, or has a DOCTYPE")
        return SourcePackage(folder, manifest=it(why), files=files)
    depends = (text[:_LONGEST] for tag, text in found.elements if tag in _DEPENDS)
    return SourcePackage(
        folder,
        name=found.name[:_LONGEST],
        build_type=(found.build_type or "")[:_LONGEST],
        manifest=it(found.fault) if found.fault else NOTHING,
        depends=tuple(dict.fromkeys(depends))[:_MOST_DEPENDS],
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
        folders[:] = _searched(at, folders)
        found += [os.path.relpath(Path(at, name), folder) for name in sorted(files)]
        if len(found) > _MOST_FILES:
            break
    return tuple(found[:_MOST_FILES])
