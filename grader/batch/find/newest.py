"""Which attempt of each counts, what it is called, and the one file or folder of it that is graded.

What an export renamed has its own name again. Ids are such that every file system takes them as
names of folders, and holds them apart.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import stat
import unicodedata
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from grader.batch import store
from grader.batch.entry import HandIn, Person
from grader.batch.find.attempt import Attempt, Piece, moment, short, tell
from grader.batch.find.joining import is_of_roster
from grader.message import NOTHING, Message, msg
from grader.submission.folder import is_junk, shown

_EMPTY: Final = msg("What was handed in is an empty folder.")
_NOWHERE: Final = msg("What was handed in is a link that leads nowhere.")
_ELSEWHERE: Final = msg("What was handed in is a link to a folder. Hand in the folder itself.")
_NO_FILE: Final = msg(
    "What was handed in is neither a file nor a folder, but a pipe, a socket or a device. "
    "It was not opened."
)
MAX_ID: Final = 80  # characters; what lies in the folder has room for its own names
_OTHERS: Final = re.compile(r"[^A-Za-z0-9._@+-]+")
#: Names that Windows keeps for devices, also with an ending.
_DEVICES: Final = re.compile(r"(?:con|prn|aux|nul|com\d|lpt\d)(?:\..*)?", re.IGNORECASE)
#: What stays of these when their accents are taken away is not what people write for them.
_SPELLED: Final = str.maketrans({"ß": "ss", "æ": "ae", "ø": "o", "ł": "l", "đ": "d", "œ": "oe"})


def hand_ins(attempts: Iterable[Attempt], place: Path) -> tuple[list[HandIn], list[Message]]:
    """The newest attempt of each, and which others there are."""
    by_whom: dict[str, list[Attempt]] = defaultdict(list)
    for attempt in attempts:
        by_whom[attempt.whose].append(attempt)
    newest = [_newest(own) for own in by_whom.values()]
    several = [own[0].people[0] for own in by_whom.values() if len(own) > 1]
    newest, moved = _one_each(newest)
    ids = safe_ids([_id(attempt) for attempt in newest])
    made = [_hand_in(attempt, id, place / id) for attempt, id in zip(newest, ids, strict=True)]
    notes: list[Message] = []
    again = msg("Handed in again, alone or in another group; for them the newest counts: {names}.")
    tell(notes, again, (person.name or person.id for person in moved))
    more = msg("Several attempts, of which the newest counts: {names}.")
    tell(notes, more, (person.name or person.id for person in several))
    return sorted(made, key=lambda hand_in: hand_in.id), notes


def _newest(attempts: list[Attempt]) -> Attempt:
    """By time if all have one, else by number, else as they were found; it is given its number."""
    timed = all(attempt.at for attempt in attempts)
    ordered = sorted(attempts, key=lambda each: (moment(each.at) if timed else 0.0, each.number))
    chosen = ordered[-1]
    return chosen if chosen.number else replace(chosen, number=len(attempts))


def _one_each(attempts: Sequence[Attempt]) -> tuple[list[Attempt], list[Person]]:
    """Each member of a group in his newest attempt alone, and who has more than one.

    Whoever the roster knows and whoever it does not are never the same, whatever their ids.
    """
    own: dict[tuple[bool, str], list[int]] = defaultdict(list)
    for number, attempt in enumerate(attempts):
        for person in attempt.people:
            own[is_of_roster(attempt), person.id].append(number)
    stays = list(map(list[Person], (attempt.people for attempt in attempts)))
    moved = []
    for (_, id), numbers in own.items():
        if len(numbers) == 1 or all(len(attempts[number].people) == 1 for number in numbers):
            continue
        last = max(numbers, key=lambda number: moment(attempts[number].at))
        moved += [person for person in attempts[last].people if person.id == id]
        for number in set(numbers) - {last}:
            stays[number] = [person for person in stays[number] if person.id != id]
    pairs = zip(attempts, stays, strict=True)
    return [replace(each, people=tuple(people)) for each, people in pairs if people], moved


def _id(attempt: Attempt) -> str:
    ids = [person.id for person in attempt.people]
    if len("+".join(ids)) <= MAX_ID:
        return "+".join(ids)
    return f"{ids[0]}+{len(ids) - 1}" if len(ids) > 1 else ids[0]


def _hand_in(attempt: Attempt, id: str, place: Path) -> HandIn:
    piece: Piece | None = None
    problem = attempt.problem
    for each in attempt.pieces:
        problem = problem or _no_submission(each.path)
    if not problem:
        piece = staged(attempt, place)
        problem = _EMPTY if piece is None else NOTHING
    return HandIn(
        id,
        attempt.people,
        None if piece is None else piece.path,
        filename="" if piece is None else shown(piece.name),
        attempt=attempt.number,
        at=attempt.at,
        problem=problem,
    )


def _no_submission(path: Path) -> Message:
    """Why nothing at a path may be opened; '' if it is a file or a folder.

    What lies behind a link to a folder is not the student's. Whoever grades a link to a file
    refuses it, unless it leads to a file of the same submission.
    """
    try:
        mode = path.stat().st_mode
    except OSError:  # it leads nowhere, or to itself
        return _NOWHERE
    if stat.S_ISDIR(mode):
        return _ELSEWHERE if path.is_symlink() else NOTHING
    return NOTHING if stat.S_ISREG(mode) else _NO_FILE


def staged(attempt: Attempt, place: Path) -> Piece | None:
    """The one file or folder that an attempt is; None where it is empty.

    Args:
        place: a folder to be made, if it takes one; its files are links or copies.

    Raises:
        OSError: something cannot be read or copied.
    """
    pieces = [piece for piece in attempt.pieces if not _is_empty(piece.path)]
    if not pieces:
        return None
    if len(pieces) == 1 and pieces[0].path.is_dir():
        only = _only_file(pieces[0].path) if attempt.alone else None
        return pieces[0] if only is None else Piece(only, only.name)
    if len(pieces) == 1 and pieces[0].path.name == pieces[0].name:
        return pieces[0]
    place.mkdir(parents=True)
    laid = [path for path in (_lay(piece, place) for piece in pieces) if path is not None]
    if len(laid) == 1 and len(pieces) == 1:
        return Piece(laid[0], laid[0].name)
    return Piece(place) if laid else None


def _lay(piece: Piece, place: Path) -> Path | None:
    """Put a file or a folder in its place; links are not followed."""
    target = _free(place, piece.name or piece.path.name)
    mode = piece.path.lstat().st_mode
    if stat.S_ISDIR(mode):
        shutil.copytree(piece.path, target, symlinks=True)
    elif stat.S_ISREG(mode):
        try:
            os.link(piece.path, target)
        except OSError:  # another file system, or not ours to link
            shutil.copyfile(piece.path, target)
    else:
        return None
    return target


def _free(place: Path, name: str) -> Path:
    """A path in a folder for a name that a stranger has given."""
    if name in (".", "..") or "/" in name or os.sep in name or "\0" in name:
        name = "submission"
    name = short(name)
    target, number = place / name, 2
    while os.path.lexists(target):
        target = place / f"{number}-{name}"
        number += 1
    return target


def _only_file(folder: Path) -> Path | None:
    """The file that a folder holds, if it holds nothing else."""
    try:
        entries = [path for path in folder.iterdir() if not is_junk(path.name)]
    except OSError:
        return None
    is_one = len(entries) == 1 and entries[0].is_file() and not entries[0].is_symlink()
    return entries[0] if is_one else None


def _is_empty(path: Path) -> bool:
    """Whether there is no file in a folder, but what a system has left there."""
    if not path.is_dir() or not os.access(path, os.R_OK):
        return False  # whoever grades it will tell why it cannot be read
    below = store.below(path, lambda each: is_junk(each.name))
    return all(each.is_dir() and not each.is_symlink() for _, each in below)


def safe_ids(wanted: Sequence[str]) -> list[str]:
    """An id for each of these different texts, in their order.

    It is the text itself where that is possible. What had to be changed and then is like another
    gets some signs of its hash, so that it does not depend on how many others there are.
    """
    made = [safe_id(text) for text in wanted]
    times = Counter(id.casefold() for id in made)
    keeps: dict[str, int] = {}  # of those that are alike, whose id is as wanted
    for number, (text, id) in enumerate(zip(wanted, made, strict=True)):
        if text == id:
            keeps.setdefault(id.casefold(), number)
    taken: set[str] = set()
    for number, (text, id) in enumerate(zip(wanted, made, strict=True)):
        fold = id.casefold()
        if times[fold] > 1 and keeps.get(fold) != number:
            made[number] = _marked(id, text)
        while made[number].casefold() in taken:
            made[number] = _marked(id, f"{text}\0{number}")
            text += "\0"
        taken.add(made[number].casefold())
    return made


def safe_id(text: str) -> str:
    """An id made of letters, digits and `._@+-` alone, and not one that a system keeps."""
    plain = unicodedata.normalize("NFKD", text.translate(_SPELLED))
    letters = "".join(sign for sign in plain if not unicodedata.combining(sign))
    id = _OTHERS.sub("-", letters).lstrip(".-").rstrip(".-")
    unwritten = sum(not sign.isascii() and sign.isalnum() for sign in letters)
    if len(id) > MAX_ID or unwritten:  # without them two names may be one
        id = _marked(id, text)
    return f"_{id}" if _DEVICES.fullmatch(id) else id or _marked("", text)


def _marked(id: str, text: str) -> str:
    digest = hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:8]
    return f"{id[: MAX_ID - 9].rstrip('.-')}-{digest}" if id else f"student-{digest}"
