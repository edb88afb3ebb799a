"""Who is in a class: `roster.csv`, or what a course system exports of its participants.

Columns are known by their titles, whatever their order, case, spaces and hyphens: those of Moodle's
grading worksheet and list of participants (English, German, French), Canvas's gradebook,
Gradescope's roster, GitHub Classroom's `classroom_roster.csv`, Classroom 50's roster and its
`scores.csv`. All columns are kept: an import may ask for them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Final

from grader.batch.find.attempt import person
from grader.batch.find.table import read_table
from grader.batch.find.times import read_time
from grader.batch.hand_in import Person
from grader.errors import UsageError
from grader.language.phrase import say
from grader.submission.folder import listed, shown

#: Columns that say who it is, the best first. A person's id is of the first of them in which every
#: row has another value.
_IDS: Final = (
    *("id", "studentid", "studentnumber", "sid", "idnumber", "matriculationnumber"),
    *("matrikelnummer", "idnummer", "numérodidentification", "sisuserid", "sisloginid"),
    *("username", "user", "login", "loginid", "githubusername", "anmeldename", "nomdutilisateur"),
    *("email", "emailaddress", "mail", "emailadresse", "adressedecourriel", "identifier"),
    *("identifiant", "githubid", "participant"),
)
_NAMES: Final = ("name", "fullname", "studentname", "student", "vollständigername", "nomcomplet")
_FIRST: Final = ("firstname", "givenname", "vorname", "prénom")
_LAST: Final = ("lastname", "surname", "familyname", "nachname", "nomdefamille", "nom")
_GROUPS: Final = ("group", "groups", "team", "groupname", "teamname", "gruppe", "groupe")
#: A column of Classroom 50's `scores.csv`.
_TAGS: Final = "submissiontag"
_TIMES: Final = (
    "at",
    "handedinat",
    "submittedat",
    "submissiontime",
    _TAGS,
    "lastmodifiedsubmission",
)
#: "Participant 17", in whatever language: Moodle's number of a participant in one assignment.
_PARTICIPANT: Final = re.compile(r"[^\d@]{5,} (\d+)")
#: `submit/2026-06-01T14-32-05Z`, as Classroom 50 calls a hand-in.
_TAG: Final = re.compile(r"submit/(.+)")
#: Rows of Canvas's gradebook that are nobody.
_NOBODY: Final = ("points possible", "student, test", "test student")


@dataclass(frozen=True)
class Member:
    """One row.

    Attributes:
        keys: all that may stand for this person in an export; compared by `folded`.
        groups: he is in.
        at: when this person handed in, if the roster says so.
    """

    person: Person
    keys: tuple[str, ...]
    groups: tuple[str, ...] = ()
    at: datetime | None = None


@dataclass(frozen=True)
class Roster:
    """All who are in a class.

    Attributes:
        name: of its file.
        notes: what is odd about it.
    """

    name: str
    members: Sequence[Member]
    notes: Sequence[str] = ()


def folded(text: str) -> str:
    """A text for comparison: without case, and without white space around it."""
    return text.strip().casefold()


def is_of_classroom50(path: Path) -> bool:
    """Whether a table is Classroom 50's `scores.csv`, and nobody else's of this name."""
    try:
        titles, _ = read_table(path)
    except UsageError:
        return False
    return _TAGS in map(_squashed, titles)


def read_roster(path: Path) -> Roster:
    """Read a roster.

    Raises:
        UsageError: it cannot be read, or no column of it says who somebody is.
    """
    titles, rows = read_table(path)
    columns = {_squashed(title): at for at, title in reversed(list(enumerate(titles)))}
    ids = [columns[title] for title in _IDS if title in columns]
    names = _Names(columns)
    if not ids and not names.is_there:
        raise UsageError(
            say(
                "{name} has no column that says who somebody is: it has {titles}. "
                "Expected one called id, name, email, username or the like in the first line.",
                name=shown(path.name),
                titles=listed(titles),
            )
        )
    rows = [row for row in rows if folded(names.of(row)) not in _NOBODY]
    keyed = [row for row in rows if any(row[at] for at in ids) or names.of(row)]
    notes = [_nameless(path, len(rows) - len(keyed))] if len(keyed) < len(rows) else []
    # first of all the column that tells everybody apart, else whatever a row has
    ids.sort(key=lambda at: not _tells_apart(row[at] for row in keyed))
    members: dict[str, Member] = {}
    twice: list[str] = []
    for row in keyed:
        member = _member(row, ids, names.of(row), titles, columns)
        same = folded(member.person.id)
        if same not in members:
            members[same] = member
        elif _TAGS in columns:  # one row each time that somebody handed in
            members[same] = max(members[same], member, key=_moment)
        else:
            twice.append(member.person.id)
    if unread := [row for row in keyed if (said := _time(row, columns)) and not _moment_of(said)]:
        whose = [next((row[at] for at in ids if row[at]), names.of(row)) for row in unread]
        notes.append(_unread(path, whose, [_time(row, columns) for row in unread]))
    if twice:
        notes.append(_twice(path, twice))
    return Roster(path.name, list(members.values()), notes)


class _Names:
    """Where a table has names."""

    def __init__(self, columns: dict[str, int]) -> None:
        def first(titles: Iterable[str]) -> list[int]:
            return [columns[title] for title in titles if title in columns][:1]

        self._whole, self._parts = first(_NAMES), first(_FIRST) + first(_LAST)

    @property
    def is_there(self) -> bool:
        return bool(self._whole or self._parts)

    def of(self, row: Sequence[str]) -> str:
        whole = " ".join(row[at] for at in self._whole)
        return whole or " ".join(filter(None, (row[at] for at in self._parts)))


def _member(
    row: Sequence[str],
    ids: Sequence[int],
    name: str,
    titles: Sequence[str],
    columns: Mapping[str, int],
) -> Member:
    known = [row[at] for at in ids if row[at]]
    numbers = [match[1] for value in known if (match := _PARTICIPANT.fullmatch(value))]
    id = known[0] if known else name
    if match := _PARTICIPANT.fullmatch(id) if known else None:
        id = match[1]
    groups = {
        part.strip()
        for title in _GROUPS
        if title in columns
        for part in re.split("[,;]", row[columns[title]])
    }
    at = _moment_of(_time(row, columns))
    columns_of = {title: value for title, value in zip(titles, row, strict=True) if title}
    keys = tuple(dict.fromkeys(filter(None, (id, *known, *numbers))))
    return Member(person(id, name, columns_of), keys, tuple(sorted(groups - {""})), at)


def _time(row: Sequence[str], columns: Mapping[str, int]) -> str:
    """What a row says of when it was handed in; '' for nothing, which Moodle writes as a dash."""
    said = (row[columns[title]] for title in _TIMES if title in columns)
    return next((each for each in said if each not in ("", "-")), "")


def _moment_of(said: str) -> datetime | None:
    tag = _TAG.fullmatch(said)
    return read_time(tag[1] if tag else said)


def _unread(path: Path, whose: Sequence[str], times: Sequence[str]) -> str:
    pairs = zip(map(shown, whose), map(shown, times), strict=True)
    return say(
        "These times in {name} cannot be read, and count as unknown: {times}. "
        "Expected one such as 2026-11-01T12:30:00+01:00, or Moodle's in English; without a zone it "
        "is this machine's local time.",
        name=shown(path.name),
        times=listed(say("{where}: {note}", where=who, note=at) for who, at in pairs),
    )


def _twice(path: Path, ids: Sequence[str]) -> str:
    return say(
        "{name} has several rows of the same id, of which the first counts: {ids}.",
        name=shown(path.name),
        ids=listed(ids),
    )


def _moment(member: Member) -> float:
    return member.at.timestamp() if member.at else float("-inf")


def _tells_apart(values: Iterable[str]) -> bool:
    found = [folded(value) for value in values]
    return all(found) and len(set(found)) == len(found)


def _nameless(path: Path, number: int) -> str:
    return say(
        "{number} of the rows of {name} say neither an id nor a name.",
        number=number,
        name=shown(path.name),
    )


def _squashed(title: str) -> str:
    return re.sub(r"[\W_]+", "", title.casefold())
