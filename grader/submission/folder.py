"""The files of a submitted folder: which of them count."""

from __future__ import annotations

import errno
import os
import re
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path, PurePath
from typing import Final

from grader.errors import SubmissionError
from grader.submission import safe_files
from grader.submission.request import Request
from grader.text.message import msg
from grader.text.strings import shown

MAX_DEPTH: Final = 8  # folders below the top that are searched
#: Errors of one file, and not of the machine.
UNREADABLE: Final = (
    *(errno.EACCES, errno.EPERM, errno.ENOENT, errno.ENXIO),
    *(errno.ENOTDIR, errno.ELOOP, errno.ENAMETOOLONG),
)
MAX_ENTRIES: Final = 10_000  # files and folders that are searched
MAX_SOURCE_BYTES: Final = 1_000_000  # a Python or set-up file larger than this is not read here
MAX_BYTES: Final = 200_000_000  # of all files together, where they are unpacked or copied

CMAKE: Final = "CMakeLists.txt"
SETUP_FILES: Final = ("pyproject.toml", "setup.py", "setup.cfg")  # the first to name a script wins

RESULT: Final = "result.json"
BEGINNING_BYTES: Final = 200  # of a file are read to recognise a result
_OUR_RESULT: Final = re.compile(rb'\s*\{\s*"schema"\s*:\s*"turtlesim-grader/result/')

HAND_IN: Final = msg("Hand in a .py file, the folder of your package, or a .zip of it.")

_JUNK: Final = {"__pycache__", "__MACOSX", "Thumbs.db", "desktop.ini"}
_COLCON: Final = {"build", "install", "log"}
#: colcon passes by a folder with one of these files.
_PASSED_BY: Final = ("COLCON_IGNORE", "AMENT_IGNORE")
#: Names of folders that are not searched, but for a package.
NO_SOURCES: Final = {"venv", "env", "test", "tests"} | _COLCON


@dataclass(frozen=True)
class SubmissionFolder:
    """A submission as a folder, submitted as such or unpacked, and its names in messages."""

    name: str  # "alice.zip"
    base: Path  # absolute; messages name paths relative to it
    request: Request = field(default_factory=Request)

    def called(self, path: Path) -> str:
        """Name a path of the submission in a message."""
        return shown(path.relative_to(self.base))

    def must_hold(self, file: Path) -> None:
        """Refuse a file that is a link to somewhere else: what lies there is not the student's."""
        if not Path(os.path.realpath(file)).is_relative_to(os.path.realpath(self.base)):
            raise SubmissionError(
                "{file} is a link to a place outside of {name}. Hand in the file "
                "itself in that place.",
                file=self.called(file),
                name=self.name,
            )


def is_junk(name: str) -> bool:
    """Whether no entry of this name belongs to a submission: hidden, or left by a system."""
    return name.startswith(".") or name in _JUNK


def marks_generated(path: PurePath) -> bool:
    """Whether a file marks its folder as filled by a program: a venv, or colcon's output."""
    return path.name == "pyvenv.cfg" or (
        path.name == "COLCON_IGNORE" and path.parent.name in _COLCON
    )


def is_generated(folder: Path) -> bool:
    """Whether a folder holds such a mark, or the result of an earlier grading."""
    marks = (folder / "pyvenv.cfg", folder / "COLCON_IGNORE")
    # of os: what has too long a path for the system is not there
    if any(marks_generated(mark) and os.path.exists(mark) for mark in marks):  # noqa: PTH110
        return True
    result = folder / RESULT
    if os.path.islink(result) or not os.path.isfile(result):  # noqa: PTH113, PTH114
        return False
    with result.open("rb") as file:
        begin = file.read(BEGINNING_BYTES)
    entries = islice(folder.iterdir(), MAX_ENTRIES)
    return is_result(begin) and not any(is_source(entry.name) for entry in entries)


def is_result(begin: bytes) -> bool:
    """Whether a file called RESULT is one of this grader, by its beginning.

    Where no source lies beside it, its folder is what `grader run .` has left in a package.
    """
    return _OUR_RESULT.match(begin) is not None


def is_source(name: str) -> bool:
    """Whether a file of this name is part of a program or a package."""
    return name.endswith(".py") or name in ("package.xml", *SETUP_FILES)


def top_of(folder: Path) -> Path:
    """Go down from a folder while it holds nothing but one other."""
    for _ in range(MAX_DEPTH):
        counting = (entry for entry in folder.iterdir() if not is_junk(entry.name))
        entries = list(islice(counting, 2))
        if len(entries) != 1 or entries[0].is_symlink() or not entries[0].is_dir():
            break
        folder = entries[0]
    return folder


def entries_of(folder: Path) -> list[Path]:
    """List a folder, sorted; not more than one entry above MAX_ENTRIES."""
    return sorted(islice(folder.iterdir(), MAX_ENTRIES + 1))


def files_below(top: Path) -> list[Path]:
    """List the files that may belong to a submission, breadth first, sorted within a folder.

    Left out: what is hidden, caches, virtual environments, colcon's build, install and log, and
    tests. Links to folders are not followed.
    """
    files: list[Path] = []
    seen = 0
    level = [top]
    for _ in range(MAX_DEPTH):
        below: list[Path] = []
        for folder in level:
            everything = entries_of(folder)
            seen += len(everything)
            if seen > MAX_ENTRIES:
                raise too_many(top)
            entries = [entry for entry in everything if not is_junk(entry.name)]
            files += [entry for entry in entries if entry.is_file()]
            below += [entry for entry in entries if is_searched(entry)]
        level = below
    return files


def too_many(top: Path) -> SubmissionError:
    """The refusal of a folder with more than MAX_ENTRIES files and folders."""
    return SubmissionError(
        "{name} holds more than {max_entries:,} files and folders, too many "
        "for a submission. {hand_in}",
        name=shown(top.name),
        max_entries=MAX_ENTRIES,
        hand_in=HAND_IN,
    )


def is_searched(entry: Path) -> bool:
    """Whether a folder that is no junk is looked into for what belongs to a submission."""
    if entry.is_symlink() or not entry.is_dir() or is_generated(entry):
        return False
    # students do call a package "test": what holds a package is one, whatever its name
    is_package = (entry / "package.xml").exists() or (entry / "setup.py").exists()
    return is_package or entry.name not in NO_SOURCES


def is_passed_by(folder: Path, base: Path) -> bool:
    """Whether colcon looks into no folder of a hand-in from this one up."""
    above = (each for each in (folder, *folder.parents) if each.is_relative_to(base))
    return any(safe_files.is_file(each / mark) for each in above for mark in _PASSED_BY)


def read_bounded(path: Path) -> bytes | None:
    """Read a file; None if it has more than MAX_SOURCE_BYTES."""
    data = safe_files.read(path, MAX_SOURCE_BYTES + 1)
    return data if len(data) <= MAX_SOURCE_BYTES else None
