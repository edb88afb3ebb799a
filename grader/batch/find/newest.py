"""Which attempt of each counts, what it is called, and whether it can be graded."""

from __future__ import annotations

import stat
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from grader.batch.find.attempt import Attempt, Piece
from grader.batch.find.ids import MAX_ID, safe_ids
from grader.batch.find.joining import is_of_roster
from grader.batch.find.staging import staged
from grader.batch.hand_in import HandIn, Person
from grader.language.phrase import say
from grader.submission.folder import listed, shown

_EMPTY: Final = say("What was handed in is an empty folder.")
_NOWHERE: Final = say("What was handed in is a link that leads nowhere.")
_ELSEWHERE: Final = say("What was handed in is a link to a folder. Hand in the folder itself.")
_NO_FILE: Final = say(
    "What was handed in is neither a file nor a folder, but a pipe, a socket or a device. "
    "It was not opened."
)


def hand_ins(attempts: Iterable[Attempt], place: Path) -> tuple[list[HandIn], list[str]]:
    """The newest attempt of each, and which others there are."""
    by_whom: dict[str, list[Attempt]] = defaultdict(list)
    for attempt in attempts:
        by_whom[attempt.whose].append(attempt)
    newest = [_newest(own) for own in by_whom.values()]
    several = [own[0].people[0] for own in by_whom.values() if len(own) > 1]
    newest, moved = _one_each(newest)
    ids = safe_ids([_id(attempt) for attempt in newest])
    made = [_hand_in(attempt, id, place / id) for attempt, id in zip(newest, ids, strict=True)]
    notes: list[str] = []
    if moved:
        notes.append(
            say(
                "Handed in again, alone or in another group; for them the newest counts: {names}.",
                names=listed(person.name or person.id for person in moved),
            )
        )
    if several:
        notes.append(
            say(
                "Several attempts, of which the newest counts: {names}.",
                names=listed(person.name or person.id for person in several),
            )
        )
    return sorted(made, key=lambda hand_in: hand_in.id), notes


def _newest(attempts: list[Attempt]) -> Attempt:
    """By time if all have one, else by number, else as they were found; it is given its number."""
    timed = all(attempt.at for attempt in attempts)
    ordered = sorted(
        attempts,
        key=lambda attempt: (
            attempt.at.timestamp() if timed and attempt.at else 0.0,
            attempt.number,
        ),
    )
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
        last = max(numbers, key=lambda number: _moment(attempts[number]))
        moved += [person for person in attempts[last].people if person.id == id]
        for number in set(numbers) - {last}:
            stays[number] = [person for person in stays[number] if person.id != id]
    pairs = zip(attempts, stays, strict=True)
    return [replace(each, people=tuple(people)) for each, people in pairs if people], moved


def _moment(attempt: Attempt) -> float:
    return attempt.at.timestamp() if attempt.at else float("-inf")


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
        problem = _EMPTY if piece is None else ""
    return HandIn(
        id,
        attempt.people,
        None if piece is None else piece.path,
        filename="" if piece is None else shown(piece.name),
        attempt=attempt.number,
        at=attempt.at,
        problem=problem,
    )


def _no_submission(path: Path) -> str:
    """Why nothing at a path may be opened; '' if it is a file or a folder.

    What lies behind a link to a folder is not the student's. Whoever grades a link to a file
    refuses it, unless it leads to a file of the same submission.
    """
    try:
        mode = path.stat().st_mode
    except OSError:  # it leads nowhere, or to itself
        return _NOWHERE
    if stat.S_ISDIR(mode):
        return _ELSEWHERE if path.is_symlink() else ""
    return "" if stat.S_ISREG(mode) else _NO_FILE
