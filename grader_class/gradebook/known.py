"""Read a person's ids from the columns of a roster or an export, by the course systems' names."""

from __future__ import annotations

import re
from collections.abc import Iterable

from grader.reports import is_safe_id
from grader_class.entry import HandIn, Person

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
SIS_USER_ID, SIS_LOGIN_ID = ("SIS User ID",), ("SIS Login ID",)
#: A column `ID` is Canvas's if there are also `Student` and one of these, spelled exactly so; else
#: it may be any id.
_CANVAS = ("Section", *SIS_USER_ID, *SIS_LOGIN_ID)
#: The ends of the names of Canvas's files with online texts; they have no number of a file.
_TYPED = ("_text.html", "_link.html")
#: The name of a file or folder in the export, which may contain ids.
EXPORTED = ("Exported as",)

_PARTICIPANT = re.compile(r"(?:^|\D)(\d{1,18})$")
_MOODLE_NAME = re.compile(r"_(\d{1,18})_assignsubmission_")
#: Canvas reads the first two numbers between underscores.
_NUMBER = re.compile(r"[0-9]{1,18}")


def column(person: Person, names: Iterable[str]) -> str:
    """Return the first of these cells that is not empty; '' where there is none.

    The case of the names does not matter.
    """
    by_name = {name.strip().casefold(): value for name, value in person.columns.items()}
    cells = (by_name.get(name.casefold(), "").strip() for name in names)
    return next(filter(None, cells), "")


def safe_column(person: Person, names: Iterable[str]) -> str:
    """Return the same cell, if it is safe in a spreadsheet; else ''."""
    value = column(person, names)
    return value if is_safe_id(value) else ""


def keys(person: Person) -> set[tuple[str, str]]:
    """Return all keys by which a course system's import may find a person, as (kind, value)."""
    sis = (SIS_USER_ID, SIS_LOGIN_ID)
    found = {(names[0], column(person, names).casefold()) for names in (*MOODLE_KEYS, *sis)}
    found.add(("ID", canvas_id(person)))
    if is_of_worksheet(person):
        found.add((IDENTIFIER[0], participant(person)))
    return {(kind, value) for kind, value in found if value}


def participant(person: Person) -> str:
    """Return Moodle's number of a person in one assignment; '' where it is unknown."""
    found = _PARTICIPANT.search(column(person, IDENTIFIER))
    found = found or _MOODLE_NAME.search(column(person, EXPORTED))
    return found[1] if found else ""


def identifier(person: Person) -> str:
    """Return the participant in the format of a grading worksheet: "Participant 123"."""
    there, number = safe_column(person, IDENTIFIER), participant(person)
    return there if number and there not in ("", number) else f"Participant {number}"


def is_of_worksheet(person: Person) -> bool:
    """Whether a person's columns are those of Moodle's grading worksheet."""
    return bool(column(person, IDENTIFIER)) and bool(column(person, (_WORKSHEET,)))


def canvas_file(hand_in: HandIn) -> str:
    """Return Canvas's name of the submitted file; '' where it is not Canvas's, or unknown."""
    for person in hand_in.people:
        name = column(person, EXPORTED)
        if len(_canvas_numbers(name)) == 2 or name.startswith("anon_"):
            return name
    return ""


def canvas_id(person: Person) -> str:
    """Return Canvas's number of a person; '' where it is unknown."""
    if "Student" in person.columns and any(name in person.columns for name in _CANVAS):
        value = person.columns.get("ID", "")
        if _NUMBER.fullmatch(value):
            return value
    name = column(person, EXPORTED)
    numbers = _canvas_numbers(name)
    is_whole = len(numbers) == 2 or name.endswith(_TYPED)
    return numbers[0] if numbers and is_whole else ""


def _canvas_numbers(name: str) -> list[str]:
    """Return the user's and the file's number in a name of Canvas's: doe_jane_LATE_12_345_x.py."""
    if _MOODLE_NAME.search(name):
        return []
    return [part for part in name.split("_")[:-1] if _NUMBER.fullmatch(part)][:2]
