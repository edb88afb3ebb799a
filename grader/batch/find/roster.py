"""Read the members of a class from a CSV table: `roster.csv`, or a course system's export.

Columns are recognised by their titles, whatever their order, case, spaces and hyphens: those of
Moodle's grading worksheet and list of participants (English, German, French), Canvas's gradebook,
Gradescope's roster, GitHub Classroom's `classroom_roster.csv`, Classroom 50's roster and its
`scores.csv`. All columns are kept: an import may ask for them.
"""

from __future__ import annotations

import codecs
import csv
import io
import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Final

from grader.batch.entry import Person
from grader.batch.find.attempt import moment, person, read_time
from grader.errors import UsageError
from grader.message import Message, msg
from grader.submission.folder import listed, shown

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
#: Rows of Canvas's gradebook that are no person.
_NOBODY: Final = ("points possible", "student, test", "test student")
MAX_BYTES: Final = 50_000_000
_DELIMITERS: Final = ",;\t|"
_UTF_16: Final = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


@dataclass(frozen=True)
class RosterMember:
    """One row.

    Attributes:
        keys: everything that may identify this person in an export; compared by `folded`.
        groups: those of this person.
        at: when this person handed in, if the roster contains it.
    """

    person: Person
    keys: tuple[str, ...]
    groups: tuple[str, ...] = ()
    at: datetime | None = None


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


def folded(text: str) -> str:
    """Return a text for comparison: without case, and without white space around it."""
    return text.strip().casefold()


def is_of_classroom50(path: Path) -> bool:
    """Whether a table is Classroom 50's `scores.csv`, and not another file of this name."""
    try:
        titles, _ = read_table(path)
    except UsageError:
        return False
    return _TAGS in map(letters, titles)


def read_roster(path: Path) -> Roster:
    """Read a roster.

    Raises:
        UsageError: it cannot be read, or no column identifies a person.
    """
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
    everybody = (_Line(titles, line) for line in lines)
    rows = [row for row in everybody if folded(row.name) not in _NOBODY]
    keyed = [row for row in rows if row.filled(ids) or row.name]
    notes = []
    if nameless := len(rows) - len(keyed):
        notes.append(
            msg(
                "{number} of the rows of {name} say neither an id nor a name.",
                number=nameless,
                name=shown(path.name),
            )
        )
    # first the columns whose values all differ, then the others
    ids.sort(key=lambda title: not _all_differ(row.cells[title] for row in keyed))
    members: dict[str, RosterMember] = {}
    twice: list[str] = []
    for row in keyed:
        member = _member(row, ids)
        same = folded(member.person.id)
        if same not in members:
            members[same] = member
        elif _TAGS in there:  # one row for each attempt
            members[same] = max(members[same], member, key=lambda each: moment(each.at))
        else:
            twice.append(member.person.id)
    if unread := [row for row in keyed if row.time and not row.at]:
        notes.append(_unread(path, [((*row.filled(ids), row.name)[0], row.time) for row in unread]))
    if twice:
        notes.append(
            msg(
                "{name} has several rows of the same id, of which the first counts: {ids}.",
                name=shown(path.name),
                ids=listed(twice),
            )
        )
    return Roster(path.name, list(members.values()), notes)


class _Line:
    """One row of a table.

    Attributes:
        columns: its cells by the titles of their columns.
        cells: its cells by the titles as `letters`; of equal titles the first counts.
    """

    def __init__(self, titles: Sequence[str], line: Sequence[str]) -> None:
        pairs = list(zip(titles, line, strict=True))
        self.columns = {title: cell for title, cell in pairs if title}
        self.cells = {letters(title): cell for title, cell in reversed(pairs)}

    def filled(self, titles: Iterable[str]) -> list[str]:
        """Return the cells of these columns that are not empty."""
        return [cell for title in titles if (cell := self.cells.get(title))]

    @property
    def name(self) -> str:
        """The name of the person; '' where there is none."""
        whole = self._first(_NAMES)
        return whole or " ".join(filter(None, (self._first(_FIRST), self._first(_LAST))))

    def _first(self, titles: Iterable[str]) -> str:
        return next((self.cells[title] for title in titles if title in self.cells), "")

    @property
    def time(self) -> str:
        """The text of the time of submission; '' for none, which Moodle writes as a dash."""
        return next((cell for cell in self.filled(_TIMES) if cell != "-"), "")

    @property
    def at(self) -> datetime | None:
        """The time of submission, if `time` can be parsed."""
        tag = _TAG.fullmatch(self.time)
        return read_time(tag[1] if tag else self.time)


def _member(row: _Line, ids: Sequence[str]) -> RosterMember:
    known = row.filled(ids)
    numbers = [match[1] for value in known if (match := _PARTICIPANT.fullmatch(value))]
    id = known[0] if known else row.name
    if match := _PARTICIPANT.fullmatch(id) if known else None:
        id = match[1]
    parts = (part.strip() for cell in row.filled(_GROUPS) for part in re.split("[,;]", cell))
    groups = sorted(set(parts) - {""})
    keys = tuple(dict.fromkeys(filter(None, (id, *known, *numbers))))
    return RosterMember(person(id, row.name, row.columns), keys, tuple(groups), row.at)


def _unread(path: Path, times: Iterable[tuple[str, str]]) -> Message:
    return msg(
        "These times in {name} cannot be read, and count as unknown: {times}. "
        "Expected one such as 2026-11-01T12:30:00+01:00, or Moodle's in English; without a zone it "
        "is this machine's local time.",
        name=shown(path.name),
        times=listed(msg("{where}: {note}", where=shown(who), note=shown(at)) for who, at in times),
    )


def _all_differ(values: Iterable[str]) -> bool:
    found = [folded(value) for value in values]
    return all(found) and len(set(found)) == len(found)


def letters(text: str) -> str:
    """Return letters and digits alone, without case: Canvas's form of names, and that of titles."""
    return re.sub(r"[\W_]+", "", text.casefold())


def read_table(path: Path) -> tuple[list[str], list[list[str]]]:
    """Read the titles of the columns, and the rows, each with as many cells as there are titles.

    The encoding is UTF-8, with or without a byte order mark; UTF-16 with one, as in Excel's
    "Unicode text"; else Windows-1252. The delimiter is the most frequent of comma, semicolon, tab
    and bar in the first line, outside of quotes, unless the file begins with Excel's `sep=;`.

    Raises:
        UsageError: there is no such file, or it is no table.
    """
    name = shown(path.name)
    try:
        with path.open("rb") as file:
            raw = file.read(MAX_BYTES + 1)
    except OSError as error:
        raise UsageError(
            "cannot read the roster {path}: {why}", path=shown(path), why=str(error.strerror)
        ) from None
    if len(raw) > MAX_BYTES:
        raise UsageError(
            "{name} has more than {size:g} MB: that is no roster", name=name, size=MAX_BYTES / 1e6
        )
    text = _decoded(raw)
    if "\0" in text:
        raise UsageError("{name} is no CSV file. Save the table as CSV, and name that.", name=name)
    first, _, rest = text.partition("\n")
    if first.strip().lower().startswith("sep="):
        delimiter, text = first.strip()[4:5] or ",", rest
    else:
        delimiter = _delimiter(first)
    try:
        lines = list(csv.reader(io.StringIO(text, newline=""), delimiter=delimiter))
    except csv.Error as error:
        raise UsageError(
            "{name} is no table in CSV: {error}", name=name, error=str(error)
        ) from None
    filled = [line for line in lines if any(cell.strip() for cell in line)]
    if not filled:
        raise UsageError(
            "{name} is empty: expected a first line with titles such as id,name", name=name
        )
    titles = [cell.strip() for cell in filled[0]]
    rows = [[cell.strip() for cell in line[: len(titles)]] for line in filled[1:]]
    return titles, [row + [""] * (len(titles) - len(row)) for row in rows]


def _decoded(raw: bytes) -> str:
    if raw.startswith(_UTF_16):
        return raw.decode("utf-16", "replace")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252", "replace")


def _delimiter(line: str) -> str:
    outside = "".join(line.split('"')[::2])
    times = Counter(sign for sign in outside if sign in _DELIMITERS)
    return max(_DELIMITERS, key=lambda sign: times[sign]) if times else ","
