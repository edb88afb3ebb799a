"""Read the members of a class from a CSV table: `roster.csv`, or a course system's export.

Columns are recognised by their titles, whatever their order, case, spaces and hyphens: those of
Moodle (in English, German, French), Canvas, Gradescope, GitHub Classroom and Classroom 50. All
columns are kept: an import may ask for them.
"""

from __future__ import annotations

import codecs
import csv
import io
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Final

from grader import UsageError
from grader.text import Message, listed, msg, shown
from grader_class.entry import Person, comparable
from grader_class.find.attempt import moment, person, read_time

#: Columns that identify a person, the best first. The id is that of the first one in which all rows
#: differ.
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
    *("at", "handedinat", "submittedat", "submissiontime", _TAGS, "lastmodifiedsubmission"),
)
#: "Participant 17", in whatever language: Moodle's number of a participant in one assignment.
_PARTICIPANT: Final = re.compile(r"[^\d@]{5,} (\d+)")
#: `submit/2026-06-01T14-32-05Z`, as Classroom 50 calls a hand-in.
_TAG: Final = re.compile(r"submit/(.+)")
#: Rows of Canvas's gradebook that are no person.
_NOBODY: Final = ("points possible", "student, test", "test student")
MAX_BYTES: Final = 50_000_000
_DELIMITERS: Final = ",;\t|"


@dataclass(frozen=True)
class RosterMember:
    """One row.

    Attributes:
        keys: everything that may identify this person in an export; compared by `comparable`.
        groups: those of this person.
        at: when this person handed in, if the roster contains it.
        unread: the text of that time, if it is none.
    """

    person: Person
    keys: tuple[str, ...]
    groups: tuple[str, ...] = ()
    at: datetime | None = None
    unread: str = ""

    @property
    def id(self) -> str:
        return self.person.id


@dataclass(frozen=True)
class Roster:
    """The members of a class.

    Attributes:
        name: of its file.
        notes: sentences about rows that could not be used as they are.
    """

    name: str
    members: Sequence[RosterMember]
    notes: Sequence[Message] = ()


def letters(text: str) -> str:
    """Return letters and digits alone, without case: Canvas's form of names, and that of titles."""
    return re.sub(r"[\W_]+", "", text.casefold())


def is_of_classroom50(path: Path) -> bool:
    """Whether a table is Classroom 50's `scores.csv`, and not another file of this name."""
    try:
        titles, _ = read_table(path)
    except UsageError:
        return False
    return _TAGS in map(letters, titles)


def read_roster(path: Path) -> Roster:
    """Read a roster; rows without an id and a name are left out."""
    titles, lines = read_table(path)
    there = set(map(letters, titles))
    ids = [title for title in _IDS if title in there]
    if not ids and there.isdisjoint((*_NAMES, *_FIRST, *_LAST)):
        raise UsageError(
            "{name} has no column that says who somebody is: it has {titles}. "
            "Expected one called id, name, email, username or the like in the first line.",
            name=shown(path.name),
            titles=listed(titles),
        )
    rows = [_Row(titles, line) for line in lines]
    rows = [
        row for row in rows if comparable(row.name) not in _NOBODY and (row.name or row.filled(ids))
    ]
    # first the columns whose values all differ, then the others
    ids.sort(key=lambda title: not _all_differ([row.cells[title] for row in rows]))
    members: dict[str, RosterMember] = {}
    twice: list[str] = []
    for member in (_member(row, ids) for row in rows):
        same = comparable(member.id)
        if same not in members:
            members[same] = member
        elif _TAGS in there:  # one row for each attempt
            members[same] = max(members[same], member, key=lambda each: moment(each.at))
        else:
            twice.append(member.id)
    notes = []
    if unread := [each for each in members.values() if each.unread]:
        notes.append(
            msg(
                "These times in {name} cannot be read, and count as unknown: {times}. "
                "Expected one such as 2026-11-01T12:30:00+01:00, or Moodle's in English; without "
                "a zone it is this machine's local time.",
                name=shown(path.name),
                times=listed(
                    msg("{where}: {note}", where=shown(each.id), note=shown(each.unread))
                    for each in unread
                ),
            )
        )
    if twice:
        notes.append(
            msg(
                "{name} has several rows of the same id, of which the first counts: {ids}.",
                name=shown(path.name),
                ids=listed(twice),
            )
        )
    return Roster(path.name, list(members.values()), notes)


class _Row:
    """One row of a table.

    Attributes:
        columns: its cells by the titles of their columns.
        cells: its cells by the titles as `letters`; of equal titles the first counts.
        name: of the person; '' where there is none.
    """

    def __init__(self, titles: Sequence[str], line: Sequence[str]) -> None:
        pairs = list(zip(titles, line, strict=True))
        self.columns = {title: cell for title, cell in pairs if title}
        self.cells = {letters(title): cell for title, cell in reversed(pairs)}
        whole, *parts = ("".join(self.filled(each)[:1]) for each in (_NAMES, _FIRST, _LAST))
        self.name = whole or " ".join(filter(None, parts))

    def filled(self, titles: Iterable[str]) -> list[str]:
        """Return the cells of these columns that are not empty."""
        return [cell for title in titles if (cell := self.cells.get(title))]


def _member(row: _Row, ids: Sequence[str]) -> RosterMember:
    known = row.filled(ids) or [row.name]
    numbers = [match[1] for value in known if (match := _PARTICIPANT.fullmatch(value))]
    id = numbers[0] if _PARTICIPANT.fullmatch(known[0]) else known[0]
    groups = {part.strip() for cell in row.filled(_GROUPS) for part in re.split("[,;]", cell)}
    time = next((cell for cell in row.filled(_TIMES) if cell != "-"), "")  # Moodle's for none
    tag = _TAG.fullmatch(time)
    at = read_time(tag[1] if tag else time)
    return RosterMember(
        person(id, row.name, row.columns),
        keys=tuple(dict.fromkeys((id, *known, *numbers))),
        groups=tuple(sorted(groups - {""})),
        at=at,
        unread="" if at else time,
    )


def _all_differ(values: Sequence[str]) -> bool:
    return all(values) and len(set(map(comparable, values))) == len(values)


def read_table(path: Path) -> tuple[list[str], list[list[str]]]:
    """Read the titles of the columns, and the rows, each with as many cells as there are titles.

    The encoding is UTF-8, with or without a byte order mark; UTF-16 with one, as in Excel's
    "Unicode text"; else Windows-1252. The delimiter is the most frequent of comma, semicolon, tab
    and bar in the first line, outside of quotes, unless the file begins with Excel's `sep=;`.
    """
    name = shown(path.name)
    try:
        with path.open("rb") as file:
            raw = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise UsageError(
            "cannot read the roster {path}: {why}", path=shown(path), why=str(error.strerror)
        ) from None
    text = _decoded(raw)
    if len(raw) > MAX_BYTES or "\0" in text:
        raise UsageError("{name} is no CSV file. Save the table as CSV, and name that.", name=name)
    first, _, rest = text.partition("\n")
    if first.strip().lower().startswith("sep="):
        delimiter, text = first.strip()[4:5] or ",", rest
    else:
        delimiter = max(_DELIMITERS, key="".join(first.split('"')[::2]).count)
    try:
        lines = list(csv.reader(io.StringIO(text, newline=""), delimiter=delimiter))
    except csv.Error as error:
        raise UsageError(
            "{name} is no table in CSV: {error}", name=name, error=str(error)
        ) from None
    filled = [[cell.strip() for cell in line] for line in lines if any(map(str.strip, line))]
    if not filled:
        raise UsageError(
            "{name} is empty: expected a first line with titles such as id,name", name=name
        )
    titles, *rows = filled
    return titles, [[*row, *[""] * len(titles)][: len(titles)] for row in rows]


def _decoded(raw: bytes) -> str:
    if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return raw.decode("utf-16", "replace")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", "replace")
