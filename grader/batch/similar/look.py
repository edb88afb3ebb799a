"""A class looked at together: read from its folder, written as similar.html and similar.jsonl.

All that is read is entry.json and similar.json of each hand-in, and the sources of those that are
shown. The same class gives the same bytes.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

from grader import files as whole_files
from grader.batch.entry import Entry
from grader.batch.similar import known, page, signature
from grader.batch.similar.compare import compare
from grader.batch.similar.pair import HandedIn, Look, Pair
from grader.batch.similar.shown import Class
from grader.batch.similar.signature import Signature
from grader.exercise.exercise import Exercise

PAGE: Final = "similar.html"
LINES: Final = "similar.jsonl"
SCHEMA: Final = "turtlesim-grader/pair/v1"


def look_together(entries: Sequence[Entry], exercise: Exercise, more: Iterable[Path] = ()) -> Class:
    """Compare what a class handed in.

    Args:
        entries: from `grader.batch.entry.entries`.
        more: what else everybody was given: Python files, and folders with some.

    Raises:
        ExerciseError, OSError: what was given cannot be read.
    """
    given = known.hashes(known.files(exercise, more))
    present = tuple(entry for entry in entries if entry.state != "nothing")
    order = sorted(entries, key=lambda entry: hashlib.sha256(entry.id.encode()).digest())
    numbers = {entry.id: number for number, entry in enumerate(order, 1)}
    signatures = tuple(signature.read(entry.folder) for entry in present)
    handed_in = [
        HandedIn(_content(entry, found), found)
        for entry, found in zip(present, signatures, strict=True)
    ]
    return Class(present, signatures, given, compare(handed_in, given), numbers)


def write(
    entries: Sequence[Entry], exercise: Exercise, out: Path, more: Iterable[Path] = ()
) -> Look:
    """Write both files into the folder of a class.

    Raises:
        UsageError: they cannot be written.
        ExerciseError, OSError: as `look_together`.
    """
    found = look_together(entries, exercise, more)
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
    return {"schema": SCHEMA, "ids": ids, **data, "pairs_in_all": found.look.pairs_in_all}


def _content(entry: Entry, found: Signature | None) -> str:
    """Names what was handed in: its Python files, else all of it."""
    if found is not None and found.files:
        return "\n".join(sorted(file.sha256 for file in found.files))
    return entry.key
