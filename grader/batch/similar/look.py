"""A class looked at together: read from its folder, written as similar.html and similar.jsonl.

Read are entry.json and similar.json of each hand-in. The same class gives the same bytes.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

from grader import files as whole_files
from grader.batch.entry import Entry
from grader.batch.similar import behaviour, known, page
from grader.batch.similar.behaviour import Behaved
from grader.batch.similar.compare import HandedIn, Look, Pair, compare
from grader.batch.similar.shown import Class
from grader.exercise.exercise import Exercise

PAGE: Final = "similar.html"
LINES: Final = "similar.jsonl"
SCHEMA: Final = "turtlesim-grader/pair/v2"


def look_together(entries: Sequence[Entry], exercise: Exercise) -> Class:
    """Compare what a class handed in.

    Args:
        entries: from `grader.batch.entry.entries`.

    Raises:
        ExerciseError, OSError: what was given cannot be read.
    """
    given = {hashlib.sha256(each.data).hexdigest() for each in known.files(exercise)}
    present = tuple(entry for entry in entries if entry.state != "nothing")
    order = sorted(entries, key=lambda entry: hashlib.sha256(entry.id.encode()).digest())
    numbers = {entry.id: number for number, entry in enumerate(order, 1)}
    found = [behaviour.read(entry.folder) for entry in present]
    only_given = tuple(
        number
        for number, each in enumerate(found)
        if each and each.files and {file.sha256 for file in each.files} <= given
    )
    handed_in = [
        HandedIn("" if number in only_given else _content(entry, each), each)
        for number, (entry, each) in enumerate(zip(present, found, strict=True))
    ]
    return Class(present, compare(handed_in), only_given, numbers)


def write(entries: Sequence[Entry], exercise: Exercise, out: Path) -> Look:
    """Write both files into the folder of a class.

    Raises:
        UsageError: they cannot be written.
        ExerciseError, OSError: as `look_together`.
    """
    found = look_together(entries, exercise)
    whole_files.put(out / PAGE, page.render(found, exercise.title).encode("utf-8"))
    whole_files.put(out / LINES, json_lines(found).encode("utf-8"))
    return found.look


def json_lines(found: Class) -> str:
    """One line of JSON a pair, in the order of the page."""
    rows = (_row(found, pair) for pair in found.look.pairs)
    return "".join(json.dumps(row, ensure_ascii=False) + "\n" for row in rows)


def _row(found: Class, pair: Pair) -> dict[str, Any]:
    data = asdict(pair)
    first, second = data.pop("first"), data.pop("second")
    ids = [found.entries[first].id, found.entries[second].id]
    return {"schema": SCHEMA, "ids": ids, **data}


def _content(entry: Entry, found: Behaved | None) -> str:
    """Names what was handed in: its Python files, else all of it."""
    if found is not None and found.files:
        return "\n".join(sorted(file.sha256 for file in found.files))
    return entry.key
