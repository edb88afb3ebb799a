"""Finds what a class has handed in: which layout it is, whose is what, and which attempt counts."""

from __future__ import annotations

import errno
import stat
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

from grader.batch.find import canvas, class_archive, clones, gradescope, moodle, plain
from grader.batch.find.attempt import Attempt, Item, Layout, Piece, Reading, items_of
from grader.batch.find.ids import MAX_ID, safe_ids
from grader.batch.find.joining import NOTHING, UNCLEAR, is_of_roster, joined
from grader.batch.find.pattern import Pattern
from grader.batch.find.roster import Roster, is_of_classroom50, read_roster
from grader.batch.find.staging import staged
from grader.batch.hand_in import HandIn, Person
from grader.errors import UsageError
from grader.scratch import make_folder
from grader.submission.folder import listed, shown
from grader.submission.unpacking import is_archive
from grader.text import count

#: Who is in the class, if it lies among the hand-ins; the second is Classroom 50's.
ROSTER: Final = "roster.csv"
SCORES: Final = "scores.csv"
#: The first one that a folder looks like is taken; a plain folder looks like nothing.
LAYOUTS: Final[tuple[Layout, ...]] = (gradescope, moodle, canvas, clones)
_MAX_WRAPPERS: Final = 3  # folders in a folder that an archive was packed from
_EMPTY: Final = "What was handed in is an empty folder."
_NOWHERE: Final = "What was handed in is a link that leads nowhere."
_ELSEWHERE: Final = "What was handed in is a link to a folder. Hand in the folder itself."
_NO_FILE: Final = (
    "What was handed in is neither a file nor a folder, but a pipe, a socket or a device. "
    "It was not opened."
)


@dataclass(frozen=True)
class Found:
    """What a class has handed in.

    Attributes:
        hand_ins: of each student or group one, sorted by id.
        notes: sentences for the teacher: how it was read, what was left out, who is unknown.
    """

    hand_ins: list[HandIn]
    notes: list[str] = field(default_factory=list)


@contextmanager
def find(
    submissions: Path, pattern: str | None = None, roster: Path | None = None
) -> Iterator[Found]:
    """Find the hand-ins; what had to be unpacked or renamed is there until the context ends.

    Args:
        submissions: the export of a course system, a folder or an archive, or any folder.
        pattern: how names are made, where that is not recognised: see `pattern.py`.
        roster: who is in the class, a CSV file; else `roster.csv` in the folder, if there is one.

    Raises:
        UsageError: there is nothing to be found there, or pattern or roster make no sense.
        GraderFailure: there is no place for files.
    """
    names = None if pattern is None else Pattern(pattern)
    with make_folder() as scratch:
        try:
            found = _found(submissions, names, roster, scratch.resolve())
        except OSError as error:
            if error.errno == errno.ENOSPC:
                raise UsageError(
                    f"there is no space left in {scratch.parent} for what was handed in. "
                    "Set TMPDIR to a folder with more."
                ) from None
            where = error.filename or submissions
            raise UsageError(f"cannot read {shown(str(where))}: {error.strerror}") from None
        yield found


def _found(submissions: Path, names: Pattern | None, roster: Path | None, scratch: Path) -> Found:
    folder, notes = _folder(submissions, scratch)
    folder, items, lying = _top(submissions, folder, names)
    reading = _read(submissions, items, names)
    attempts, about = list(reading.attempts), list(reading.notes)
    if known := _roster(roster, lying):
        attempts, unknown = joined(attempts, known, reading.layout == plain.LAYOUT)
        about += unknown
    hand_ins, older = _hand_ins(attempts, scratch / "hand_ins")
    if not hand_ins:
        raise UsageError(f"{shown(submissions)} holds no submissions. Check the path.")
    missing = sum(hand_in.problem in (NOTHING, UNCLEAR) for hand_in in hand_ins)
    there = count(len(hand_ins) - missing, "hand-in")
    first = f"Read as {reading.layout}: {there}{f', {missing} missing' if missing else ''}."
    if reading.layout == plain.LAYOUT:
        first += " If that is wrong, say with --pattern how the names are made."
    return Found(hand_ins, [first, *notes, *about, *older])


# Where to look -----------------------------------------------------------------------------------


def _folder(submissions: Path, scratch: Path) -> tuple[Path, list[str]]:
    """The folder that was named, or what was in the archive."""
    if submissions.is_dir():
        return submissions, []
    if not submissions.exists():
        raise UsageError(f"{shown(submissions)} does not exist. Check the name and the folder.")
    if is_archive(submissions) and submissions.is_file():
        folder = scratch / "class"
        return folder, class_archive.unpack(submissions, folder)
    if submissions.suffix == ".py":
        raise _is_one(submissions, "it is a Python file")
    raise UsageError(
        f"{shown(submissions)} is neither a folder of submissions nor a .zip or .tar.gz of one."
    )


def _top(
    submissions: Path, folder: Path, names: Pattern | None
) -> tuple[Path, list[Item], dict[str, Item]]:
    """The folder in which hand-ins lie, what they are, and the rosters beside them.

    A folder is often packed as such, and so lies alone in what comes out of the archive; that of an
    export does so also where a browser has unpacked it.
    """
    lying: dict[str, Item] = {}
    for _ in range(_MAX_WRAPPERS + 1):
        items = []
        for item in items_of(folder):
            if item.name.lower() in (ROSTER, SCORES) and item.path.is_file():
                lying[item.name.lower()] = item
            elif not _is_ours(item):
                items.append(item)
        if len(items) != 1 or not items[0].is_folder or names or _layout(items):
            break
        below = items_of(items[0].path)
        is_packed = folder != submissions and below
        if not _layout(below):
            if not is_packed:
                break
            if what := plain.one_submission(below):
                raise _is_one(submissions, f"it holds {what}")
        folder = items[0].path
    return folder, items, lying


def _is_ours(item: Item) -> bool:
    """Whether it is what `grader batch` has left there."""
    return item.is_folder and all((item.path / name).exists() for name in ("class.json", "store"))


def _layout(items: Sequence[Item]) -> Layout | None:
    return next((layout for layout in LAYOUTS if layout.looks_like(items)), None)


def _read(submissions: Path, items: Sequence[Item], names: Pattern | None) -> Reading:
    """What is there, by the first layout that it looks like."""
    if names is not None:
        return names.read(items)
    if layout := _layout(items):
        return layout.read(items)
    if what := plain.one_submission(items):
        raise _is_one(submissions, f"it holds {what}")
    return plain.read(items)


def _is_one(submissions: Path, what: str) -> UsageError:
    return UsageError(
        f"{shown(submissions)} is one submission, and not a folder of them: {what}. "
        f"Use: grader run {shown(submissions)}"
    )


def _roster(given: Path | None, lying: dict[str, Item]) -> Roster | None:
    if given is not None:
        return read_roster(given)
    if item := lying.get(ROSTER):
        return read_roster(item.path)
    item = lying.get(SCORES)
    return read_roster(item.path) if item and is_of_classroom50(item.path) else None


# Which attempt counts, and what it is called ------------------------------------------------------


def _hand_ins(attempts: Iterable[Attempt], place: Path) -> tuple[list[HandIn], list[str]]:
    """The newest attempt of each, and which others there are."""
    by_whom: dict[str, list[Attempt]] = defaultdict(list)
    for attempt in attempts:
        by_whom[attempt.whose].append(attempt)
    newest = [_newest(own) for own in by_whom.values()]
    several = [own[0].people[0] for own in by_whom.values() if len(own) > 1]
    newest, moved = _one_each(newest)
    ids = safe_ids([_id(attempt) for attempt in newest])
    made = [_hand_in(attempt, id, place / id) for attempt, id in zip(newest, ids, strict=True)]
    notes = []
    if moved:
        told = "Handed in again, alone or in another group; for them the newest counts"
        notes.append(f"{told}: {listed(person.name or person.id for person in moved)}.")
    if several:
        names = listed(person.name or person.id for person in several)
        notes.append(f"Several attempts, of which the newest counts: {names}.")
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
