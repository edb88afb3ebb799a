"""Choose the newest attempt of each student, its id, and the one file or folder that is graded.

What an export renamed gets its original name again. Ids are distinct and valid names of folders on
every file system.
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

from grader.submission import is_junk, short
from grader.text import NOTHING, Message, msg, shown
from grader_class import store
from grader_class.entry import MAX_ID, HandIn, Person, id_of
from grader_class.find.attempt import Attempt, Piece, add_note, moment
from grader_class.find.joining import is_of_roster

#: Letters that people spell otherwise than by leaving out the accent.
_SPELLED = str.maketrans(
    {"ß": "ss", "æ": "ae", "ø": "o", "ł": "l", "đ": "d", "œ": "oe", "ı": "i"}
    | {"ẞ": "SS", "Æ": "AE", "Ø": "O", "Ł": "L", "Đ": "D", "Œ": "OE"}
)
_EMPTY: Final = msg("What was handed in is an empty folder.")
_NOWHERE: Final = msg("What was handed in is a link that leads nowhere.")
_ELSEWHERE: Final = msg("What was handed in is a link to a folder. Hand in the folder itself.")
_NO_FILE: Final = msg(
    "What was handed in is neither a file nor a folder, but a pipe, a socket or a device. "
    "It was not opened."
)
_OTHERS: Final = re.compile(r"[^A-Za-z0-9._@+-]+")
#: Names that Windows reserves for devices, also with a suffix.
_DEVICES: Final = re.compile(r"(?:con|prn|aux|nul|com\d|lpt\d)(?:\..*)?", re.IGNORECASE)


def hand_ins(attempts: Iterable[Attempt], place: Path) -> tuple[list[HandIn], list[Message]]:
    """Return the newest attempt of each as hand-ins sorted by id, and notes on the others."""
    by_whom: dict[str, list[Attempt]] = defaultdict(list)
    for attempt in attempts:
        by_whom[attempt.whose].append(attempt)
    newest = [_newest(each) for each in by_whom.values()]
    several = [each[0].people[0] for each in by_whom.values() if len(each) > 1]
    newest, moved = _one_each(newest)
    ids = safe_ids([id_of([person.id for person in each.people]) for each in newest])
    made = [_hand_in(attempt, id, place / id) for attempt, id in zip(newest, ids, strict=True)]
    notes: list[Message] = []
    again = msg("Handed in again, alone or in another group; for them the newest counts: {names}.")
    add_note(notes, again, (person.name or person.id for person in moved))
    more = msg("Several attempts, of which the newest counts: {names}.")
    add_note(notes, more, (person.name or person.id for person in several))
    return sorted(made, key=lambda hand_in: hand_in.id), notes


def _newest(attempts: list[Attempt]) -> Attempt:
    """Return the newest: by time if all have one, else by number, else the last; number it."""
    timed = all(attempt.at for attempt in attempts)
    ordered = sorted(attempts, key=lambda each: (moment(each.at) if timed else 0.0, each.number))
    chosen = ordered[-1]
    return chosen if chosen.number else replace(chosen, number=len(attempts))


def _one_each(attempts: Sequence[Attempt]) -> tuple[list[Attempt], list[Person]]:
    """Keep each member of a group in the newest attempt alone; also return who had more than one.

    A member of the roster and an unknown person are never the same, whatever their ids.
    """
    newest: dict[tuple[bool, str], Attempt] = {}
    for attempt in sorted(attempts, key=lambda each: moment(each.at), reverse=True):
        for key in _keys(attempt):
            newest.setdefault(key, attempt)
    members = {key for each in attempts if len(each.people) > 1 for key in _keys(each)}
    kept, moved = [], dict[str, Person]()
    for attempt in attempts:
        pairs = list(zip(_keys(attempt), attempt.people, strict=True))
        gone = {key for key, _ in pairs if key in members and newest[key] is not attempt}
        moved |= {person.id: person for key, person in pairs if key in gone}
        if people := tuple(person for key, person in pairs if key not in gone):
            kept.append(replace(attempt, people=people))
    return kept, list(moved.values())


def _keys(attempt: Attempt) -> list[tuple[bool, str]]:
    return [(is_of_roster(attempt), person.id) for person in attempt.people]


def _hand_in(attempt: Attempt, id: str, place: Path) -> HandIn:
    piece: Piece | None = None
    problem = attempt.problem
    for each in attempt.pieces:
        problem = problem or _no_submission(each.path)
    if not problem:
        piece = _assembled(attempt, place)
        problem = _EMPTY if piece is None else NOTHING
    return HandIn(
        id,
        attempt.people,
        None if piece is None else piece.path,
        filename="" if piece is None else shown(piece.name),
        attempt=attempt.number,
        at=attempt.at,
        problem=problem,
        is_marked_late=attempt.is_marked_late,
    )


def _no_submission(path: Path) -> Message:
    """Return why a path may not be opened; '' if it is a file or a folder.

    The target of a link to a folder is not the student's. A link to a file is refused later, when
    it is graded, unless it leads to a file of the same submission.
    """
    try:
        mode = path.stat().st_mode
    except OSError:  # it leads nowhere, or to itself
        return _NOWHERE
    if stat.S_ISDIR(mode):
        return _ELSEWHERE if path.is_symlink() else NOTHING
    return NOTHING if stat.S_ISREG(mode) else _NO_FILE


def _assembled(attempt: Attempt, place: Path) -> Piece | None:
    """Return an attempt as one file or folder; None where it is empty.

    Args:
        place: a folder to be made, if one is needed; its files are links or copies.
    """
    pieces = [piece for piece in attempt.pieces if not _is_empty(piece.path)]
    if len(pieces) == 1:
        (piece,) = pieces
        if piece.path.is_dir():
            only = _only_file(piece.path) if attempt.alone else None
            return piece if only is None else Piece(only, only.name)
        if piece.path.name == piece.name:
            return piece
    if pieces:
        place.mkdir(parents=True)
    laid = [path for path in (_lay(piece, place) for piece in pieces) if path is not None]
    if len(laid) == 1 and len(pieces) == 1:
        return Piece(laid[0], laid[0].name)
    return Piece(place) if laid else None


def _lay(piece: Piece, place: Path) -> Path | None:
    """Link or copy a file or a folder into a place; links are not followed."""
    target = _free(place, piece.name or piece.path.name)
    mode = piece.path.lstat().st_mode
    if stat.S_ISDIR(mode):
        shutil.copytree(piece.path, target, symlinks=True)
    elif stat.S_ISREG(mode):
        store.link(str(piece.path), str(target))
    else:
        return None
    return target


def _free(place: Path, name: str) -> Path:
    """Return a free path in a folder for an untrusted name."""
    name = "submission" if name in (".", "..") or {"/", "\0"} & {*name} else short(name)
    target, number = place / name, 2
    while os.path.lexists(target):
        target = place / f"{number}-{name}"
        number += 1
    return target


def _only_file(folder: Path) -> Path | None:
    """Return the file in a folder, if the folder holds nothing else."""
    try:
        entries = [path for path in folder.iterdir() if not is_junk(path.name)]
    except OSError:
        return None
    is_one = len(entries) == 1 and entries[0].is_file() and not entries[0].is_symlink()
    return entries[0] if is_one else None


def _is_empty(path: Path) -> bool:
    """Whether a folder holds no files but junk."""
    if not path.is_dir() or not os.access(path, os.R_OK):
        return False  # grading will report why it cannot be read
    below = store.below(path, lambda each: is_junk(each.name))
    return all(each.is_dir() and not each.is_symlink() for _, each in below)


def safe_ids(wanted: Sequence[str]) -> list[str]:
    """Return an id for each of these different texts, in their order.

    It is the text itself where that is valid. An id that had to be changed and then equals another
    gets a part of its text's hash, so that it does not depend on how many others there are.
    """
    made = [safe_id(text) for text in wanted]
    times = Counter(id.casefold() for id in made)
    used: set[str] = set()
    for number in sorted(range(len(made)), key=lambda at: made[at] != wanted[at]):
        text, id = wanted[number], made[number]
        if text != id and times[id.casefold()] > 1:
            id = _marked(id, text)
        while id.casefold() in used:
            id = _marked(made[number], text)
            text += "\0"
        used.add(id.casefold())
        made[number] = id
    return made


def safe_id(text: str) -> str:
    """Return an id of letters, digits and `._@+-` alone, and none that a system reserves."""
    letters = _unaccented(text)
    id = _OTHERS.sub("-", letters).lstrip(".-").rstrip(".-")
    unwritten = sum(not sign.isascii() and sign.isalnum() for sign in letters)
    if len(id) > MAX_ID or unwritten:  # without them two names may be one
        id = _marked(id, text)
    return f"_{id}" if _DEVICES.fullmatch(id) else id or _marked("", text)


def _marked(id: str, text: str) -> str:
    digest = hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:8]
    return f"{id[: MAX_ID - 9].rstrip('.-')}-{digest}" if id else f"student-{digest}"


def _unaccented(text: str) -> str:
    """Return a text with its letters without accents, in their case: `Zoe` for `Zoë`."""
    if text.isascii():
        return text
    made = unicodedata.normalize("NFKD", text.translate(_SPELLED))
    return "".join(sign for sign in made if not unicodedata.combining(sign))
