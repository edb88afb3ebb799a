"""What lies in a handed-in folder: which files count, and how messages name them."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import Final

from grader.errors import SubmissionError

MAX_DEPTH: Final = 8  # folders below the top that are searched
MAX_ENTRIES: Final = 10_000  # files and folders that are looked at
MAX_SOURCE_BYTES: Final = 1_000_000  # a Python or set-up file larger than this is not read here

HAND_IN: Final = "Hand in a .py file, the folder of your package, or a .zip of it."

_JUNK: Final = {"__pycache__", "__MACOSX", "Thumbs.db", "desktop.ini"}
_COLCON: Final = {"build", "install", "log"}
_NO_SOURCES: Final = {"venv", "env", "test", "tests"} | _COLCON


@dataclass(frozen=True)
class HandedIn:
    """A folder, handed in as such or unpacked, and its words in messages."""

    name: str  # "alice.zip"
    base: Path  # absolute; messages name paths relative to it

    def called(self, path: Path) -> str:
        """Name a path of the submission in a message."""
        return str(path.relative_to(self.base))


def is_junk(name: str) -> bool:
    """Tell whether no entry of this name belongs to a submission: hidden, or left by a system."""
    return name.startswith(".") or name in _JUNK


def marks_generated(path: PurePath) -> bool:
    """Tell whether a file says that a program filled its folder: a venv, or colcon's output."""
    return path.name == "pyvenv.cfg" or (
        path.name == "COLCON_IGNORE" and path.parent.name in _COLCON
    )


def is_generated(folder: Path) -> bool:
    """Tell whether a folder holds such a mark."""
    marks = (folder / "pyvenv.cfg", folder / "COLCON_IGNORE")
    return any(marks_generated(mark) and mark.exists() for mark in marks)


def top_of(folder: Path) -> Path:
    """Go down from a folder while it holds nothing but one other."""
    for _ in range(MAX_DEPTH):
        entries = [entry for entry in folder.iterdir() if not is_junk(entry.name)]
        if len(entries) != 1 or entries[0].is_symlink() or not entries[0].is_dir():
            break
        folder = entries[0]
    return folder


def files_below(top: Path) -> list[Path]:
    """List the files that may belong to a submission, breadth first, sorted within a folder.

    Left out: what is hidden, caches, virtual environments, colcon's build, install and log, and
    tests. Links to folders are not followed.

    Raises:
        SubmissionError: there are more than MAX_ENTRIES.
        OSError: a folder cannot be read.
    """
    files: list[Path] = []
    seen = 0
    level = [top]
    for _ in range(MAX_DEPTH):
        below: list[Path] = []
        for folder in level:
            entries = sorted(entry for entry in folder.iterdir() if not is_junk(entry.name))
            seen += len(entries)
            if seen > MAX_ENTRIES:
                raise SubmissionError(
                    f"{top.name} holds more than {MAX_ENTRIES:,} files and folders, too many for "
                    f"a submission. {HAND_IN}"
                )
            files += [entry for entry in entries if entry.is_file()]
            below += [entry for entry in entries if _is_searched(entry)]
        level = below
    return files


def _is_searched(entry: Path) -> bool:
    if entry.is_symlink() or not entry.is_dir() or is_generated(entry):
        return False
    # students do call a package "test": what holds a package is one, whatever its name
    is_package = (entry / "package.xml").exists() or (entry / "setup.py").exists()
    return is_package or entry.name not in _NO_SOURCES


def read_bounded(path: Path) -> bytes | None:
    """Read a file; None if it has more than MAX_SOURCE_BYTES."""
    with path.open("rb") as file:
        data = file.read(MAX_SOURCE_BYTES + 1)
    return data if len(data) <= MAX_SOURCE_BYTES else None


def listed(names: Iterable[str], limit: int = 10) -> str:
    """Join names as in "a, b, c and 4 more"."""
    every = list(names)
    if len(every) <= limit:
        return ", ".join(every)
    return f"{', '.join(every[:limit])} and {len(every) - limit} more"


def near(wanted: str, names: Sequence[str]) -> list[str]:
    """Pick the names that `wanted` may have meant: a typing error or another case; best first."""
    by_folded = {name.casefold(): name for name in reversed(names)}
    return [by_folded[name] for name in difflib.get_close_matches(wanted.casefold(), by_folded)]
