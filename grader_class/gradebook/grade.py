"""The grade of one person, and the ids by which course systems find the person."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from grader.reports.wording import points
from grader.text import tr
from grader_class.entry import Entry, HandIn, Person
from grader_class.find.joining import UNCLEAR
from grader_class.reports.csv import is_safe_id

#: The longest text in a cell [characters].
LONGEST = 300

#: The keys of a person in Moodle's grade import, the most reliable first, each with the names that
#: rosters and exports have for it. The first is Moodle's own name.
MOODLE_KEYS = (
    ("Email address", "email", "e-mail", "mail"),
    ("ID number", "idnumber"),
    ("Username", "user name"),
)
#: "Participant 123" in a grading worksheet; 123 if it was read from the name of a folder.
IDENTIFIER = ("Identifier", "Participant number")
_WORKSHEET = "Last modified (grade)"
SIS_USER_ID, SIS_LOGIN_ID = "SIS User ID", "SIS Login ID"
#: A column `ID` is Canvas's if there are also `Student` and one of these, spelled exactly so; else
#: it may be any id.
_CANVAS = ("Section", SIS_USER_ID, SIS_LOGIN_ID)
#: The ends of the names of Canvas's files with online texts; they have no number of a file.
_TYPED = ("_text.html", "_link.html")
#: The name of a file or folder in the export, which may contain ids.
EXPORTED = "Exported as"
_PARTICIPANT = re.compile(r"(?:^|\D)(\d{1,18})$")
_MOODLE_NAME = re.compile(r"_(\d{1,18})_assignsubmission_")
#: Canvas reads the first two numbers between underscores.
_NUMBER = re.compile(r"[0-9]{1,18}")


@dataclass(frozen=True)
class Grade:
    """The grade of one person.

    Attributes:
        entry: the graded hand-in of the person, or of the group.
        final: the points for a course system; None where it must not get any: the grader failed,
            or an unmatched hand-in may belong to this person.
        is_double: another hand-in of the same person counts, or it is unknown which one does.
    """

    person: Person
    entry: Entry
    final: float | None
    is_double: bool = False

    @property
    def score(self) -> float | None:
        """The points before the deduction for being late."""
        result = self.entry.result
        return self.final if result is None or self.final is None else result.score

    @property
    def late_days(self) -> int:
        """How many started days of lateness count."""
        submitted = self.entry.result and self.entry.result.handed_in
        return submitted.days if submitted else 0

    @property
    def late_deduction(self) -> float:
        """The deduction for being late [points]."""
        if self.score is None or self.final is None:
            return 0.0
        return round(self.score - self.final, 2)

    @property
    def group(self) -> tuple[str, ...]:
        """The ids of the members of the group; empty for somebody who worked alone."""
        people = self.entry.hand_in.people
        return tuple(person.id for person in people) if len(people) > 1 else ()


def grades(entries: Iterable[Entry]) -> list[Grade]:
    """Return the grades of all people, in the order of the entries."""
    found = []
    for entry in entries:
        final = None if entry.hand_in.problem == UNCLEAR else entry.score
        found += [Grade(person, entry, final) for person in entry.hand_in.people]
    return _one_each(found)


def _one_each(grades: list[Grade]) -> list[Grade]:
    """Return the grades, with points in at most one of those of one person for a course system.

    A hand-in counts before none, then the newer before the older. Where the order is unknown, none
    counts.
    """
    by_key: dict[tuple[str, str], list[int]] = defaultdict(list)
    for number, grade in enumerate(grades):
        for key in keys_of(grade.person):
            by_key[key].append(number)
    doubles = set[int]()
    for numbers in by_key.values():
        if len(numbers) > 1:
            doubles |= set(numbers) - {_counting(grades, numbers)}
    return [
        replace(grade, final=None, is_double=True) if number in doubles else grade
        for number, grade in enumerate(grades)
    ]


def _counting(grades: Sequence[Grade], numbers: Sequence[int]) -> int | None:
    """Return which of one person's grades counts; None where that is unknown."""
    there = [number for number in numbers if grades[number].entry.state != "nothing"]
    if len(there) < 2:
        return next(iter(there or numbers))
    times = {number: grades[number].entry.hand_in.at for number in there}
    known_times = [at for at in times.values() if at is not None]
    if len(known_times) < len(there) or known_times.count(max(known_times)) > 1:
        return None
    return next(number for number, at in times.items() if at == max(known_times))


def decimal(value: float | None) -> str:
    """Format points with two decimals and a point, for any course system; '' for None."""
    return "" if value is None else f"{value + 0.0:.2f}"


def out_of(value: float, of: float) -> str:
    """Format points for people: '12.5 of 30'."""
    return tr("{score} of {max_score}", score=points(value), max_score=points(of))


# Ids, by the names that rosters and exports have for their columns --------------------------------


def safe_column(person: Person, *names: str) -> str:
    """Return a person's cell, if it is safe in a spreadsheet; else ''."""
    value = person.column(*names)
    return value if is_safe_id(value) else ""


def keys_of(person: Person) -> set[tuple[str, str]]:
    """Return all keys by which a course system's import may find a person, as (kind, value)."""
    sis = ((SIS_USER_ID,), (SIS_LOGIN_ID,))
    found = {(names[0], person.column(*names).casefold()) for names in (*MOODLE_KEYS, *sis)}
    found.add(("ID", canvas_id(person)))
    if is_of_worksheet(person):
        found.add((IDENTIFIER[0], participant(person)))
    return {(kind, value) for kind, value in found if value}


def participant(person: Person) -> str:
    """Return Moodle's number of a person in one assignment; '' where it is unknown."""
    found = _PARTICIPANT.search(person.column(*IDENTIFIER))
    found = found or _MOODLE_NAME.search(person.column(EXPORTED))
    return found[1] if found else ""


def identifier(person: Person) -> str:
    """Return the participant in the format of a grading worksheet: "Participant 123"."""
    there, number = safe_column(person, *IDENTIFIER), participant(person)
    return there if number and there not in ("", number) else f"Participant {number}"


def is_of_worksheet(person: Person) -> bool:
    """Whether a person's columns are those of Moodle's grading worksheet."""
    return bool(person.column(*IDENTIFIER)) and bool(person.column(_WORKSHEET))


def canvas_file(hand_in: HandIn) -> str:
    """Return Canvas's name of the submitted file; '' where it is not Canvas's, or unknown."""
    for person in hand_in.people:
        name = person.column(EXPORTED)
        if len(_canvas_numbers(name)) == 2 or name.startswith("anon_"):
            return name
    return ""


def canvas_id(person: Person) -> str:
    """Return Canvas's number of a person; '' where it is unknown."""
    if "Student" in person.columns and any(name in person.columns for name in _CANVAS):
        value = person.columns.get("ID", "")
        if _NUMBER.fullmatch(value):
            return value
    name = person.column(EXPORTED)
    numbers = _canvas_numbers(name)
    is_whole = len(numbers) == 2 or name.endswith(_TYPED)
    return numbers[0] if numbers and is_whole else ""


def _canvas_numbers(name: str) -> list[str]:
    """Return the user's and the file's number in a name of Canvas's: doe_jane_LATE_12_345_x.py."""
    if _MOODLE_NAME.search(name):
        return []
    return [part for part in name.split("_")[:-1] if _NUMBER.fullmatch(part)][:2]
