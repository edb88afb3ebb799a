"""Canvas's reading of what is imported, by its own rules.

Source: lib/gradebook_importer.rb; app/models/abstract_assignment.rb, title_and_id and
infer_comment_context_from_filename.
"""

from __future__ import annotations

import csv
import io
import re
import zipfile
from dataclasses import dataclass, field


@dataclass
class Imported:
    """What an import comes to: grades by user, of an assignment by its id, else by its title."""

    assignment: str
    points_possible: str = ""
    grades: dict[int, str] = field(default_factory=dict)
    unknown: list[str] = field(default_factory=list)


def gradebook(content, users):
    """Read a gradebook: users by their id, each with name, sis and login."""
    text = content.decode("utf-8")
    assert delimiter(text) == ","
    header, *rows = csv.reader(io.StringIO(text), strict=True)
    columns = _student_columns(header)
    (heading,) = header[columns:]
    match = re.fullmatch(r"(.*)\s\((\d+)\)", heading)
    found = Imported(match[2] if match else heading)
    for row in rows:
        assert len(row) == len(header)
        if "Points Possible" in row[0]:
            found.points_possible = row[columns]
            continue
        user = _user(row, users)
        if user is None:
            found.unknown.append(row[0])
        else:
            assert user not in found.grades
            found.grades[user] = _decimal(row[columns].strip())
    return found


def delimiter(text):
    """A semicolon where the first three lines have more, and equally many, columns with it."""
    lines = list(io.StringIO(text, newline="\n"))[:3]
    sizes = {}
    for sign in ";,":
        try:
            counts = {len(next(csv.reader([line], delimiter=sign, strict=True))) for line in lines}
        except csv.Error:
            counts = set()
        sizes[sign] = counts.pop() if len(counts) == 1 else 0
    return ";" if sizes[";"] > sizes[","] else ","


def _student_columns(header):
    assert len(header) > 3
    assert "Student" in header[0]
    assert "ID" in header[1]
    columns = 3
    if re.search(r"SIS\s+User\s+ID", header[2]) and re.search(r"SIS\s+Login\s+ID", header[3]):
        columns = 5
    assert "Section" in header[columns - 1], "Invalid header row"
    return columns


def _user(row, users):
    if row[1] and int(row[1]) in users:
        return int(row[1])
    for place, name in ((2, "sis"), (3, "login"), (0, "name")):
        for number, user in users.items():
            if row[place] and user[name] == row[place]:
                return number
    return None


def _decimal(text):
    """A comma or a point is the sign before decimals; those before it are not."""
    if not re.fullmatch(r"-?[0-9.,]+%?", text):
        return text
    *whole, last = re.split(r"[,.]", text)
    return f"{''.join(whole)}.{last}" if whole else last


def feedback_zip(content, submissions):
    """Comments by user, each a file; and the names that are ignored.

    Args:
        submissions: user -> the ids of the files that he has handed in.
    """
    found, ignored = {}, []
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        for path in archive.namelist():
            name = path.rpartition("/")[2]
            parts = [part for part in name.split("_") if part != "LATE"]
            user, file, *_ = ([int(p) for p in parts if re.fullmatch(r"\d+", p)] + [0, 0])[:2]
            if parts[-1].startswith("link") or file not in submissions.get(user, ()):
                ignored.append(path)
            else:
                found[user] = (path, archive.read(path))
    return found, ignored
