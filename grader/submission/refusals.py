"""Errors where there is nothing to start, in words that a student can act on."""

from __future__ import annotations

import errno
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import Final

from grader.errors import SubmissionError, UsageError
from grader.submission.folder import HAND_IN, MAX_ENTRIES, UNREADABLE, SubmissionFolder
from grader.text.message import Message, msg
from grader.text.strings import listed, nearest, shown

PACKAGE: Final = msg("Hand in the folder of your ROS 2 package, or a .zip of it.")
CPP: Final = {".cpp", ".cc", ".cxx", ".c", ".hpp", ".h"}
_OTHER_ARCHIVES: Final = {".gz", ".bz2", ".tbz2", ".xz", ".txz", ".zst", ".rar", ".7z"}


def advice(path: Path) -> Message:
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
    return msg("Only Python can be graded. {hand_in}", hand_in=HAND_IN) if kind in CPP else HAND_IN


def missing(path: Path) -> UsageError:
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


@contextmanager
def readable(path: Path) -> Iterator[None]:
    """Turn an OSError of one file of the submission into a SubmissionError."""
    try:
        yield
    except OSError as error:
        if error.errno not in UNREADABLE:
            raise
        base, culprit = path.resolve(), Path(error.filename or path)
        advice = msg("Check its permissions, and hand it in again.")
        if error.errno == errno.ENAMETOOLONG:
            advice = msg("Shorten its name, and hand it in again.")
        raise SubmissionError(
            "{file} cannot be read: {why}. {advice}",
            file=shown(culprit.relative_to(base) if base in culprit.parents else path),
            why=str(error.strerror),
            advice=advice,
        ) from error


def no_python(submitted: SubmissionFolder, files: list[Path]) -> SubmissionError:
    """The error that there is nothing in Python, with what there is."""
    names = [submitted.called(file) for file in files]
    holds = msg(
        "it holds: {names}", names=listed(names) or msg("only folders that are not searched")
    )
    if any(file.suffix.lower() in CPP or file.name == "CMakeLists.txt" for file in files):
        return SubmissionError(
            "{name} has no Python node, but C++ ({holds}). Only Python can be graded. {hand_in}",
            name=submitted.name,
            holds=holds,
            hand_in=HAND_IN,
        )
    return SubmissionError(
        "{name} has no Python file that could be the node ({holds}). {hand_in}",
        name=submitted.name,
        holds=holds,
        hand_in=HAND_IN,
    )
