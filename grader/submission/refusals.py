"""Why there is nothing to start, in words that a student can act on."""

from __future__ import annotations

import errno
from itertools import islice
from pathlib import Path
from typing import Final

from grader.errors import SubmissionError, UsageError
from grader.language.phrase import say
from grader.submission.folder import HAND_IN, MAX_ENTRIES, HandedIn, listed, near, shown

CPP: Final = {".cpp", ".cc", ".cxx", ".c", ".hpp", ".h"}
_OTHER_ARCHIVES: Final = {".gz", ".bz2", ".tbz2", ".xz", ".txz", ".zst", ".rar", ".7z"}


def advice(path: Path) -> str:
    """What to hand in instead of a file of this kind."""
    kind = path.suffix.lower()
    if kind == ".py":
        return say(
            "Python imports no {suffix}: call it {name}.py.",
            suffix=shown(path.suffix),
            name=shown(path.stem),
        )
    if kind in _OTHER_ARCHIVES:
        return say("Unpack it, and pack the same as a .zip.")
    if kind == ".ipynb":
        return say("Save the notebook as a Python file (.py), and hand in that.")
    return say("Only Python can be graded. {hand_in}", hand_in=HAND_IN) if kind in CPP else HAND_IN


def missing(path: Path) -> UsageError:
    """Say that there is no such path."""
    folder = path.parent
    if not folder.is_dir():
        return UsageError(
            say(
                "{path} does not exist: there is no folder {folder}.",
                path=shown(path),
                folder=shown(folder),
            )
        )
    there = islice((entry.name for entry in folder.iterdir()), MAX_ENTRIES)
    meant = near(path.name, sorted(there))
    advice = (
        say("Did you mean {names}?", names=listed(meant))
        if meant
        else say("Check the name and the folder.")
    )
    return UsageError(say("{path} does not exist. {advice}", path=shown(path), advice=advice))


def unreadable(path: Path, error: OSError) -> SubmissionError:
    """Say which file cannot be read."""
    base, culprit = path.resolve(), Path(error.filename or path)
    called = culprit.relative_to(base) if base in culprit.parents else path
    is_long = error.errno == errno.ENAMETOOLONG
    return SubmissionError(
        say(
            "{file} cannot be read: {why}. Shorten its name, and hand it in again.",
            file=shown(called),
            why=str(error.strerror),
        )
        if is_long
        else say(
            "{file} cannot be read: {why}. Check its permissions, and hand it in again.",
            file=shown(called),
            why=str(error.strerror),
        )
    )


def no_python(handed_in: HandedIn, files: list[Path]) -> SubmissionError:
    """Say that there is nothing in Python, and what there is."""
    names = [handed_in.called(file) for file in files]
    holds = say(
        "it holds: {names}", names=listed(names) or say("only folders that are not searched")
    )
    if any(file.suffix.lower() in CPP or file.name == "CMakeLists.txt" for file in files):
        return SubmissionError(
            say(
                "{name} has no Python node, but C++ ({holds}). Only Python can be "
                "graded. {hand_in}",
                name=handed_in.name,
                holds=holds,
                hand_in=HAND_IN,
            )
        )
    return SubmissionError(
        say(
            "{name} has no Python file that could be the node ({holds}). {hand_in}",
            name=handed_in.name,
            holds=holds,
            hand_in=HAND_IN,
        )
    )
