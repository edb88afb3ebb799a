"""Render the class page: one self-contained file, made of entries and nothing else.

Equal entries give equal bytes: it contains neither the time nor the machine. Whatever the size of a
class, the page has a bounded number of pictures, paths and rows; further rows are on further pages,
with the table alone.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from itertools import accumulate
from pathlib import Path
from statistics import fmean

import jinja2

from grader import text
from grader.batch.entry import Entry
from grader.batch.page.checks import check_rows
from grader.batch.page.students import STATES, Student, evenly, students
from grader.batch.page.thumb import EDGE_PX, UNITS, Thumb
from grader.exercise.exercise import Exercise
from grader.recording.subject import load_subject
from grader.reports.page import templating
from grader.translations import tr, translate

_TEMPLATES = Path(__file__).parent / "templates"
#: How many students have a picture and a path, and how many a row where there is one page.
MOST_PICTURES, MOST_ROWS = 500, 4000
#: The rows of each page of a larger class: a browser has laid them out in less than a second.
ROWS = 500
PAGE, FURTHER = "index.html", "index-{}.html"


def render_all(
    entries: Sequence[Entry], exercise: Exercise, links: Mapping[str, str] | None = None
) -> dict[str, str]:
    """Return the pages by the names of their files.

    Args:
        entries: of the whole class, in any order.
        links: files beside the page: words -> relative address.
    """
    everybody = students(entries)
    judged = [student for student in everybody if student.entry.result is not None]
    scores = [e.score for e in entries if e.state != "nothing" and e.score is not None]
    results = [student.entry.result for student in judged if student.entry.result]
    each = MOST_ROWS if len(everybody) <= MOST_ROWS else ROWS
    rows = {
        FURTHER.format(first // each + 1) if first else PAGE: everybody[first : first + each]
        for first in range(0, max(1, len(everybody)), each)
    }
    ends = accumulate(map(len, rows.values()))
    numbers = [f"{end - len(own) + 1}–{end}" for end, own in zip(ends, rows.values(), strict=True)]
    render_page = partial(
        _environment().get_template("class.html").render,
        exercise=exercise,
        thing=translate(load_subject(exercise.scene).thing),
        links=links or {},
        total=len(everybody),
        parts=dict(zip(rows, numbers, strict=True)),
        mean=fmean(scores) if scores else None,
        states=_states(everybody),
        judged=len(judged),
        checks=check_rows(results, exercise.points),
        words=_script_words(),
    )
    return {
        name: render_page(page=name, rows=own, drawn=_drawn(own) if name == PAGE else [])
        for name, own in rows.items()
    }


def _states(everybody: Sequence[Student]) -> list[tuple[str, int, bool]]:
    """Return the states without a result, how often, and whether it is the grader's failure."""
    counted = Counter(student.entry.state for student in everybody)
    return [
        (translate(words), counted[state], state == "failed")
        for state, words in STATES.items()
        if counted[state]
    ]


def _script_words() -> dict[str, str]:
    """Return the sentences of the page's script; `#` is replaced by a value."""
    return {
        "found": tr("{done} of {total}", done="#", total="#"),
        "ascending": tr("Sorted by {column}, ascending", column="#"),
        "descending": tr("Sorted by {column}, descending", column="#"),
        "points": tr(": {points} points", points="#"),
        "student": tr("Student {number}", number="#"),
    }


def _drawn(rows: Sequence[Student]) -> list[Student]:
    """Return the students with a picture, and load it."""
    judged = [student for student in rows if student.entry.result is not None]
    chosen = evenly(judged, MOST_PICTURES)
    read = (replace(student, thumb=Thumb.read(student.entry.folder)) for student in chosen)
    return [student for student in read if student.thumb is not None]


@cache
def _environment() -> jinja2.Environment:
    made = templating.environment(_TEMPLATES, "class")
    made.globals.update(
        edge=EDGE_PX,
        units=UNITS,
        plain=lambda value: text.one_line(text.plain(value)),
    )
    return made
