"""What a roster or an export says of a person, by the names that course systems give to columns."""

from __future__ import annotations

import re
from collections.abc import Iterable

from grader.batch.entry import HandIn, Person
from grader.reports.csv import is_safe_id

#: Ways to name somebody that Moodle's grade import knows, the surest first, each by the names that
#: rosters and exports have for it, in small letters. The first is what Moodle calls it.
MOODLE_KEYS = (
    ("Email address", "email", "e-mail", "mail"),
    ("ID number", "idnumber"),
    ("Username", "user name"),
)
#: "Participant 123" in a grading worksheet; 123 where it was read from the name of a folder.
IDENTIFIER = ("Identifier", "Participant number")
_WORKSHEET = "Last modified (grade)"
SIS_USER_ID, SIS_LOGIN_ID = ("SIS User ID",), ("SIS Login ID",)
#: A column `ID` is Canvas's where `Student` and one of these are beside it, as Canvas writes them;
#: else it may be anybody's.
_CANVAS = ("Section", *SIS_USER_ID, *SIS_LOGIN_ID)
#: Ends the names of files that Canvas makes of what was typed in; they have no number of a file.
_TYPED = ("_text.html", "_link.html")
#: What a file or folder was called in the export, from which the ids in it can be read.
EXPORTED = ("Exported as",)

_PARTICIPANT = re.compile(r"(?:^|\D)(\d{1,18})$")
_MOODLE_NAME = re.compile(r"_(\d{1,18})_assignsubmission_")
#: As Canvas reads it: the first two parts between low lines that are numbers.
_NUMBER = re.compile(r"[0-9]{1,18}")


def column(person: Person, names: Iterable[str]) -> str:
    """What the first of these columns that there is says; '' where there is none.

    Large and small letters are alike.
    """
    by_name = {name.strip().casefold(): value for name, value in person.columns.items()}
    said = (by_name.get(name.casefold(), "").strip() for name in names)
    return next(filter(None, said), "")


def safe_column(person: Person, names: Iterable[str]) -> str:
    """The same, where it is fit for a cell; else ''."""
    value = column(person, names)
    return value if is_safe_id(value) else ""


def keys(person: Person) -> set[tuple[str, str]]:
    """All by which a course system's import may find a person: what it is, and its value."""
    sis = (SIS_USER_ID, SIS_LOGIN_ID)
    found = {(names[0], column(person, names).casefold()) for names in (*MOODLE_KEYS, *sis)}
    found.add(("ID", canvas_id(person)))
    if is_of_worksheet(person):
        found.add((IDENTIFIER[0], participant(person)))
    return {(kind, value) for kind, value in found if value}


def participant(person: Person) -> str:
    """Moodle's number of a person in one assignment; '' where it is not known."""
    found = _PARTICIPANT.search(column(person, IDENTIFIER))
    found = found or _MOODLE_NAME.search(column(person, EXPORTED))
    return found[1] if found else ""


def identifier(person: Person) -> str:
    """The same as a grading worksheet has it: "Participant 123"."""
    there, number = safe_column(person, IDENTIFIER), participant(person)
    return there if number and there not in ("", number) else f"Participant {number}"


def is_of_worksheet(person: Person) -> bool:
    """Whether Moodle's grading worksheet tells of a person."""
    return bool(column(person, IDENTIFIER)) and bool(column(person, (_WORKSHEET,)))


def canvas_file(hand_in: HandIn) -> str:
    """What Canvas called the file that was handed in; '' where it was not Canvas, or is unknown."""
    for person in hand_in.people:
        name = column(person, EXPORTED)
        if len(_canvas_numbers(name)) == 2 or name.startswith("anon_"):
            return name
    return ""


def canvas_id(person: Person) -> str:
    """Canvas's number of a person; '' where it is not known."""
    if "Student" in person.columns and any(name in person.columns for name in _CANVAS):
        value = person.columns.get("ID", "")
        if _NUMBER.fullmatch(value):
            return value
    name = column(person, EXPORTED)
    numbers = _canvas_numbers(name)
    is_whole = len(numbers) == 2 or name.endswith(_TYPED)
    return numbers[0] if numbers and is_whole else ""


def _canvas_numbers(name: str) -> list[str]:
    """The user's and the file's number in a name as Canvas gives it: doe_jane_LATE_12_345_x.py."""
    if _MOODLE_NAME.search(name):
        return []
    return [part for part in name.split("_")[:-1] if _NUMBER.fullmatch(part)][:2]
