"""Moodle's reading of what is imported, by its own rules.

Source: mod/assign/feedback/offline/importgradeslib.php and locallib.php,
mod/assign/feedback/file/importziplib.php, grade/import/csv/classes/load_data.php.
"""

from __future__ import annotations

import csv
import io
import posixpath
import zipfile
from dataclasses import dataclass

HIDDEN_USER = "Participant "


@dataclass(frozen=True)
class Graded:
    grade: float
    comment: str


def rows(content):
    """As csv_import_reader: without a mark, one kind of line break, equally many columns."""
    text = content.decode("utf-8").removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    found = list(csv.reader(io.StringIO(text), strict=True))
    assert {len(row) for row in found} == {len(found[0])}, "csvweirdcolumns"
    return found


def worksheet(content, participants, maximum):
    """The grades and comments that the upload of a grading worksheet changes, by participant."""
    header, *lines = rows(content)
    identifier, grade, _modified, comment = (
        header.index(name)
        for name in ("Identifier", "Grade", "Last modified (grade)", "Feedback comments")
    )
    found = {}
    for line in lines:
        number = int(line[identifier][len(HIDDEN_USER) :])
        points = unformat_float(line[grade])
        if number in participants and points is not None and 0 <= points <= maximum:
            found[number] = Graded(points, line[comment])
    return found


def unformat_float(text):
    """In a language with a decimal point, and in one with a comma: both take a point."""
    return float(text.replace(" ", "").replace(",", ".")) if text else None


def grade_import(content, key, grade, users):
    """The grades that the import into the course's gradebook sets, by user.

    An unknown user ends all of it; an empty one is taken for the one of the row before.
    """
    header, *lines = rows(content)
    mapped, points = header.index(key), header.index(grade)
    found = {}
    student = None
    for line in lines:
        if line[mapped].strip():
            assert line[mapped].strip() in users, f"usermappingerror: {line[mapped]}"
            student = users[line[mapped].strip()]
        assert student is not None, "usermappingerrorusernotfound"
        assert student not in found, "the grade of another student"
        found[student] = float(line[points])
    return found


def feedback_zip(content, participants):
    """The feedback files that students get, by participant and name."""
    found = {}
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        for name in archive.namelist():
            match = _matched("/import/" + name, participants)
            if match is not None:
                number, filename = match
                found.setdefault(number, {})[filename] = archive.read(name)
    return found


def _matched(path, participants):
    if posixpath.basename(path).startswith((".", "~")):
        return None
    parts = path.split("/")
    while parts:
        name, number, plugintype, plugin, *rest = (*parts.pop(0).split("_", 4), "", "", "")[:5]
        del name
        known = number.isdecimal() and int(number) in participants
        if known and (plugintype, plugin) == ("assignsubmission", "file"):
            return int(number), "/".join([*rest, *parts])
    return None
