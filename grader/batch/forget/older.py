"""Take a student out of what regrades have kept: before/N/ and regrade/.

Tables lose the student's rows. Their pages are removed: they show the first rows of the tables, and
figures of the class with the student.
"""

from __future__ import annotations

import csv
import io
import json
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from grader import files
from grader.batch.class_file import CLASS, ClassFile
from grader.batch.forget.whom import Whom
from grader.batch.gradebook.write import BYTE_ORDER_MARK, CSV, JSON_LINES
from grader.batch.regrade.judging import CHANGES_CSV, CHANGES_PAGE
from grader.batch.store import BEFORE, REGRADE
from grader.errors import UsageError
from grader.reports.csv import cell, table
from grader.text import map_all

Row = dict[str, str]


def folders(out: Path) -> list[Path]:
    """Return the folders with files of regrades."""
    return [path for path in (*sorted((out / BEFORE).glob("*/")), out / REGRADE) if path.is_dir()]


def take_out(folder: Path, whom: Whom, renamed: Mapping[str, str], *, really: bool) -> Counter[str]:
    """Take a student out of the tables of a folder; return how many rows and pages that concerns.

    Args:
        renamed: the ids of groups with the student -> what they are called from now on; '' for a
            hand-in that goes.
        really: whether to write; else it is only counted.
    """
    counted: Counter[str] = Counter()
    put = files.put if really else _nothing

    def kept(row: Row) -> Row | None:
        made = _row(row, whom, renamed)
        counted["rows" if made is None else "changed"] += made != row
        return made

    for name in (CSV, CHANGES_CSV):
        if (folder / name).is_file():
            text = _read(folder / name)
            mark = BYTE_ORDER_MARK if name == CSV else ""
            put(folder / name, f"{mark}{_table(text, kept)}".encode())
    if (folder / JSON_LINES).is_file():
        rows = (_line(row, whom, renamed) for row in _rows(folder / JSON_LINES))
        text = "".join(f"{json.dumps(row, ensure_ascii=False)}\n" for row in rows if row)
        put(folder / JSON_LINES, text.encode())
    if counted["rows"] and (folder / CLASS).is_file() and "" in renamed.values():
        found = ClassFile.read(folder)
        made = replace(found, hand_ins=max(0, found.hand_ins - 1))
        if really:
            made.put(folder)
    if (folder / CHANGES_PAGE).is_file():
        counted["pages"] += 1
        if really:
            files.clear(folder / CHANGES_PAGE)
    return +counted


def _read(path: Path) -> str:
    """Read a table of ours.

    Raises:
        UsageError: it cannot be read.
    """
    try:
        return path.read_text("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError("cannot read {path}: {why}", path=str(path), why=str(error)) from None


def _rows(path: Path) -> list[dict[str, Any]]:
    try:
        rows = [json.loads(line) for line in _read(path).splitlines()]
    except ValueError as error:
        raise UsageError("{path} is not JSON: {why}", path=path, why=str(error)) from None
    return [row for row in rows if isinstance(row, dict)]


def _nothing(path: Path, content: bytes) -> None:
    pass


def _table(text: str, kept: Callable[[Row], Row | None]) -> str:
    """Return a table with the rows that are kept."""
    reader = csv.DictReader(io.StringIO(text, newline=""))
    header = list(reader.fieldnames or ())
    rows = (row for each in reader if (row := kept(dict(each))) is not None)
    return table([header, *([row.get(title) or "" for title in header] for row in rows)])


def _row(row: Row, whom: Whom, renamed: Mapping[str, str]) -> Row | None:
    """Return a row without a student; None where it is the student's."""
    id, hand_in = row.get("id", ""), row.get("hand_in")
    own = cell(whom.person.id)
    if hand_in is not None and id == own:  # of a gradebook: a person's
        return None
    if hand_in is None and renamed.get(id) == "":  # of changes: a hand-in's
        return None
    made = dict(row)
    if hand_in is None:
        made["id"] = renamed.get(id) or whom.names(id)
        made["name"] = ", ".join(_others(row.get("name", "").split(", "), whom))
    else:
        made["hand_in"] = renamed.get(hand_in) or whom.names(hand_in)
        group = [each for each in row.get("group", "").split("; ") if each and each != own]
        made["group"] = "; ".join(group if len(group) > 1 else ())
    keep = ("id", "hand_in", "group")
    return {t: v if t in keep else whom.names(v or "") for t, v in made.items()}


def _others(names: list[str], whom: Whom) -> Iterator[str]:
    own = {cell(whom.person.name), cell(whom.person.id)}
    return (name for name in names if name not in own)


def _line(row: dict[str, Any], whom: Whom, renamed: Mapping[str, str]) -> dict[str, Any] | None:
    if row.get("id") == whom.person.id:
        return None
    hand_in = row.get("hand_in", "")
    group = [each for each in row.get("group", ()) if each != whom.person.id]
    made: dict[str, Any] = {
        **map_all(row, whom.names),
        "id": row["id"],
        "hand_in": renamed.get(hand_in) or whom.names(hand_in),
        "group": group if len(group) > 1 else [],
    }
    return made
