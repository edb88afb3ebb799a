"""Find the submissions of a class: in which folder, in which layout, and whose they are."""

from __future__ import annotations

import errno
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

from grader import SubmissionError, UsageError
from grader.submission import Budget, TooMuch, is_archive, unpack
from grader.system import make_folder
from grader.text import Message, listed, msg, shown
from grader.text import joined as joined_texts
from grader_class.class_file import CLASS
from grader_class.entry import HandIn
from grader_class.find import newest, plain
from grader_class.find.attempt import Export, Item, items_of
from grader_class.find.joining import NOT_HANDED_IN, UNCLEAR, joined
from grader_class.find.layouts import LAYOUTS, Layout
from grader_class.find.plain import Pattern
from grader_class.find.roster import Roster, is_of_classroom50, read_roster
from grader_class.store import STORE, UNFINISHED

#: The members of the class, if beside the submissions; the second is Classroom 50's.
ROSTER: Final = "roster.csv"
SCORES: Final = "scores.csv"
_TABLES: Final = (ROSTER, SCORES)
_MAX_WRAPPERS: Final = 3  # folders in a folder that an archive was packed from
LIMITS: Final = Budget(
    most_bytes=50_000_000_000, most_files=500_000, list_bytes=20_000_000, headers=500_000
)
_INSTEAD: Final = msg("Unpack it yourself, and give the folder.")
#: Of a member whose name or place does not suit this system: of no other, as a full disk is.
_UNWRITABLE: Final = (
    *(errno.EINVAL, errno.EILSEQ, errno.ENAMETOOLONG),
    *(errno.ENOTDIR, errno.EISDIR, errno.EEXIST),
)
_REFUSED: Final = msg(
    "is encrypted, a link, no ordinary file or would be written outside of its folder, and is left "
    "out"
)
_CANNOT_BE_WRITTEN: Final = msg("cannot be written here")
_DAMAGED: Final = msg("is damaged, and kept as far as it goes")


@dataclass(frozen=True)
class Found:
    """The hand-ins of a class.

    Attributes:
        hand_ins: one of each student or group, sorted by id.
        notes: sentences for the teacher: how it was read, what was left out, who is unknown.
    """

    hand_ins: list[HandIn]
    notes: list[Message] = field(default_factory=list)


@contextmanager
def find(
    submissions: Path,
    pattern: str | None = None,
    roster: Path | None = None,
    place: Path | None = None,
) -> Iterator[Found]:
    """Find the hand-ins; unpacked and renamed files last until the context ends.

    Args:
        submissions: the export of a course system, a folder or an archive, or any folder.
        pattern: of the names, where they are not recognised: see `plain.py`.
        roster: the class as a CSV file; else `roster.csv` in the folder, if there is one.
        place: an empty folder for what is unpacked; None: one of this machine's own.
    """
    names = None if pattern is None else Pattern(pattern)
    with nullcontext(place) if place else make_folder() as scratch:
        try:
            found = _found(submissions, names, roster, scratch.resolve())
        except OSError as error:
            where = shown(str(error.filename or submissions))
            raise UsageError(
                "cannot read {where}: {error}", where=where, error=str(error.strerror)
            ) from None
        yield found


def _found(submissions: Path, names: Pattern | None, roster: Path | None, scratch: Path) -> Found:
    folder, notes = _folder(submissions, scratch)
    folder, items, lying = _top(submissions, folder, names)
    reading = _read(submissions, items, names)
    attempts, about = list(reading.attempts), list(reading.notes)
    if known := _roster(roster, lying):
        attempts, unknown = joined(attempts, known)
        about += unknown
    hand_ins, older = newest.hand_ins(attempts, scratch / "hand_ins")
    if not hand_ins:
        raise UsageError("{path} holds no submissions. Check the path.", path=shown(submissions))
    first = _first_note(reading.layout, hand_ins)
    return Found(hand_ins, [first, *notes, *about, *older])


def _first_note(layout: Message, hand_ins: Sequence[HandIn]) -> Message:
    """Return which layout was read, and how many hand-ins there are."""
    missing = sum(hand_in.problem in (NOT_HANDED_IN, UNCLEAR) for hand_in in hand_ins)
    there = len(hand_ins) - missing
    notes = [
        msg(
            "Read as {layout}: {n:,} hand-in.",
            "Read as {layout}: {n:,} hand-ins.",
            n=there,
            layout=layout,
        )
    ]
    if missing:
        notes.append(msg("Missing: {missing}.", missing=missing))
    if layout == plain.LAYOUT:
        notes.append(msg("If that is wrong, say with --pattern how the names are made."))
    return joined_texts(notes, " ")


# Which folder ------------------------------------------------------------------------------------


def _folder(submissions: Path, scratch: Path) -> tuple[Path, list[Message]]:
    """Return the folder that was named, or the unpacked archive, and notes on unpacking."""
    if submissions.is_dir():
        return submissions, []
    if not submissions.exists():
        raise UsageError(
            "{path} does not exist. Check the name and the folder.", path=shown(submissions)
        )
    if is_archive(submissions) and submissions.is_file():
        folder = scratch / "class"
        return folder, _unpack(submissions, folder)
    if submissions.suffix == ".py":
        raise _is_one(submissions, msg("it is a Python file"))
    raise UsageError(
        "{path} is neither a folder of submissions nor a .zip or .tar.gz of one.",
        path=shown(submissions),
    )


def _unpack(archive: Path, into: Path) -> list[Message]:
    """Unpack the archive of a class into `into`, a folder to be made; return notes.

    A course's server made it, with names and contents from students. A member that cannot be used
    is left out and reported: one student must not keep the others from being graded. The students'
    archives inside of it are not unpacked here.
    """
    odd: dict[Message, list[str]] = defaultdict(list)

    def report(name: str, error: Exception) -> None:
        if isinstance(error, SubmissionError):
            odd[_REFUSED].append(name)
        elif isinstance(error, OSError) and error.errno in _UNWRITABLE:
            odd[_CANNOT_BE_WRITTEN].append(name)
        elif isinstance(error, OSError) and error.errno is not None:
            raise error
        else:
            odd[_DAMAGED].append(name)

    into.mkdir()
    try:
        unpack(archive, into, replace(LIMITS), report)
    except TooMuch:
        raise UsageError(
            "{name} unpacks to more than {size:g} GB, or {files:,} files, the limit for a class. "
            "{instead}",
            name=shown(archive.name),
            size=LIMITS.most_bytes / 1e9,
            files=LIMITS.most_files,
            instead=_INSTEAD,
        ) from None
    except SubmissionError as error:
        raise UsageError(error.message.given(pack_again=_INSTEAD)) from None
    return [
        msg(
            "Of what {name} holds, some {what}: {names}.",
            name=shown(archive.name),
            what=what,
            names=listed(names),
        )
        for what, names in odd.items()
    ]


def _top(
    submissions: Path, folder: Path, names: Pattern | None
) -> tuple[Path, list[Item], dict[str, Item]]:
    """Return the folder of the hand-ins, its items, and the rosters beside them.

    A folder is often packed as such, and so is the only item of its archive; the folder of an
    export is also nested where a browser has unpacked it.
    """
    lying: dict[str, Item] = {}
    for _ in range(_MAX_WRAPPERS + 1):
        found = items_of(folder)
        tables = [each for each in found if each.name.lower() in _TABLES and each.path.is_file()]
        lying |= {each.name.lower(): each for each in tables}
        items = [each for each in found if each not in tables and not _is_ours(each)]
        if len(items) != 1 or not items[0].is_folder or names or _layout(items):
            break
        below = items_of(items[0].path)
        if not _layout(below):
            if folder == submissions or not below:
                break
            _check_several(submissions, below)
        folder = items[0].path
    return folder, items, lying


def _is_ours(item: Item) -> bool:
    """Whether it is a folder that `grader batch` writes into, perhaps now."""
    ours = (item.path / name for name in (CLASS, UNFINISHED))
    return item.is_folder and (item.path / STORE).exists() and any(map(Path.exists, ours))


def _layout(items: Sequence[Item]) -> Layout | None:
    return next((layout for layout in LAYOUTS if layout.matches(items)), None)


def _read(submissions: Path, items: Sequence[Item], names: Pattern | None) -> Export:
    """Read the attempts by the pattern, else by the first layout that matches."""
    if names is not None:
        return names.read(items)
    if layout := _layout(items):
        return layout.read(items)
    _check_several(submissions, items)
    return plain.read(items)


def _check_several(submissions: Path, items: Sequence[Item]) -> None:
    if what := plain.one_submission(items):
        raise _is_one(submissions, msg("it holds {what}", what=shown(what)))


def _is_one(submissions: Path, what: Message) -> UsageError:
    return UsageError(
        "{path} is one submission, and not a folder of them: {what}. Use: grader run {path}",
        path=shown(submissions),
        what=what,
    )


def _roster(given: Path | None, lying: dict[str, Item]) -> Roster | None:
    if given is None and ROSTER in lying:
        given = lying[ROSTER].path
    if given is None and SCORES in lying and is_of_classroom50(lying[SCORES].path):
        given = lying[SCORES].path
    return None if given is None else read_roster(given)
