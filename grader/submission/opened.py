"""Opens a folder or an archive that was handed in, and an archive that lies in it alone.

The archives of one submission lie one inside another, up to MAX_LEVELS; together they have one
limit.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Final, NamedTuple

from grader.errors import SubmissionError, UsageError
from grader.submission.folder import (
    CMAKE,
    HAND_IN,
    MAX_ENTRIES,
    SubmissionFolder,
    entries_of,
    files_below,
    is_junk,
    is_source,
    top_of,
)
from grader.submission.request import Request
from grader.submission.safe_members import Budget
from grader.text.message import Message, msg
from grader.text.strings import listed, nearest, shown

#: A zip of a course's server, in it the student's own, in that a zip once more by mistake.
MAX_LEVELS: Final = 3

_ENDINGS: Final = (".zip", ".tar", ".tar.gz", ".tgz")
_OTHER_ARCHIVES: Final = {".gz", ".bz2", ".tbz2", ".xz", ".txz", ".zst", ".rar", ".7z"}
CPP: Final = {".cpp", ".cc", ".cxx", ".c", ".hpp", ".h"}
ONLY_PYTHON: Final = msg("Only Python can be graded. {hand_in}", hand_in=HAND_IN)
PACKAGE: Final = msg("Hand in the folder of your ROS 2 package, or a .zip of it.")


class Opened(NamedTuple):
    """A submission that is a folder, or was unpacked into one.

    Attributes:
        files: those that may belong to it.
        inside: the archives in it that were unpacked, the innermost first.
    """

    submitted: SubmissionFolder
    files: list[Path]
    inside: tuple[str, ...]


def is_archive(path: Path) -> bool:
    """Whether a file can be unpacked, by its name."""
    return path.name.lower().endswith(_ENDINGS)


def opened(path: Path, request: Request, scratch: Path) -> Opened:
    """Open a submission that is no single file.

    Args:
        scratch: an empty folder, for what has to be unpacked.

    Raises:
        SubmissionError: it is neither a folder nor an archive, is empty, or cannot be unpacked.
        UsageError: there is no such path.
    """
    name = shown(path.name or path.resolve().name)
    if not path.exists():
        raise _missing(path)
    if not path.is_dir() and not is_archive(path):
        raise SubmissionError(
            "{name} is neither a .py file, nor a folder, nor a .zip or .tar.gz. {advice}",
            name=name,
            advice=_advice(path) if request.is_started else PACKAGE,
        )
    budget, inside = Budget(), tuple[str, ...]()
    base = path.resolve() if path.is_dir() else _unpacked(path, scratch, budget)
    submitted = SubmissionFolder(name, base, request)
    while True:
        top = top_of(submitted.base)
        if all(is_junk(entry.name) for entry in entries_of(top)):
            raise SubmissionError(
                "{name} is an empty folder. {hand_in}", name=name, hand_in=HAND_IN
            )
        files = files_below(top)
        archives = [file for file in files if is_archive(file)]
        if not archives or any(map(_is_part, files)):
            return Opened(submitted, files, inside)
        if len(archives) > 1:
            raise SubmissionError(
                "{name} holds several archives, and no Python file beside them: "
                "{names}. Hand in only one of them.",
                name=name,
                names=listed(map(submitted.called, archives)),
            )
        submitted.must_hold(archives[0])
        inside = (submitted.called(archives[0]), *inside)
        submitted = replace(submitted, base=_unpacked(archives[0], scratch, budget))


def _is_part(file: Path) -> bool:
    """Whether a file shows that its folder is what was handed in, rather than an archive in it."""
    return is_source(file.name) or file.name == CMAKE or file.suffix.lower() in CPP


def _unpacked(archive: Path, scratch: Path, budget: Budget) -> Path:
    """Unpack an archive; return the folder of its content."""
    from grader.submission.unpacking import unpack  # here: most submissions are none

    places = (scratch / f"unpacked{level or ''}" for level in range(MAX_LEVELS))
    place = next((each for each in places if not each.exists()), None)
    if place is None:
        raise SubmissionError(
            "{name} lies in an archive in an archive in an archive, which is too "
            "deep. Hand in the innermost.",
            name=shown(archive.name),
        )
    if not archive.is_file():
        raise SubmissionError("{name} is not an ordinary file.", name=shown(archive.name))
    place.mkdir()
    unpack(archive, place, budget)
    return place


def _advice(path: Path) -> Message:
    """Say what to hand in instead of a file of this kind."""
    kind = path.suffix.lower()
    if kind == ".py":
        return msg(
            "Python imports no {suffix}: call it {name}.py.",
            suffix=shown(path.suffix),
            name=shown(path.stem),
        )
    if kind in _OTHER_ARCHIVES:
        return msg("Unpack it, and pack the same as a .zip.")
    if kind == ".ipynb":
        return msg("Save the notebook as a Python file (.py), and hand in that.")
    return ONLY_PYTHON if kind in CPP else HAND_IN


def _missing(path: Path) -> UsageError:
    """The error that there is no such path."""
    folder = path.parent
    if not folder.is_dir():
        return UsageError(
            "{path} does not exist: there is no folder {folder}.",
            path=shown(path),
            folder=shown(folder),
        )
    there = islice((entry.name for entry in folder.iterdir()), MAX_ENTRIES)
    meant = nearest(path.name, sorted(there))
    advice = (
        msg("Did you mean {names}?", names=listed(meant))
        if meant
        else msg("Check the name and the folder.")
    )
    return UsageError("{path} does not exist. {advice}", path=shown(path), advice=advice)
