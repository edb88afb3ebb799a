"""Render the class page: one self-contained file, made of entries and nothing else.

Equal entries give equal bytes: it contains neither the time nor the machine. Whatever the size of a
class, the page has a bounded number of pictures, paths and rows; further rows are on further pages,
with the table alone.
"""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, partial
from itertools import accumulate
from pathlib import Path
from statistics import fmean
from typing import Final
from urllib.parse import quote

import jinja2

from grader import Exercise, Result, Verdict
from grader.exercise import SubmissionInfo
from grader.reports import templating
from grader.reports.wording import outcome_text, points
from grader.scenes import load_subject
from grader.text import NOTHING, Message, clip, msg, plain, shown, tr, translate
from grader_class.entry import SUBMISSIONS, Entry, State
from grader_class.page.thumb import EDGE_PX, UNITS, Thumb

_TEMPLATES = Path(__file__).parent / "templates"
#: How many students have a picture and a path, and how many a row where there is one page.
MOST_PICTURES, MOST_ROWS = 500, 4000
#: The rows of each page of a larger class: a browser has laid them out in less than a second.
ROWS = 500
PAGE, FURTHER = "index.html", "index-{}.html"
_NAME_LIMIT, _WORD_LIMIT = 80, 40
_LONGEST_LINE = 400
#: Whether it is about the run as a whole, and not about the check.
_Line = tuple[bool, Message]
#: The states without a result, in words.
STATES: Final[Mapping[State, Message]] = {
    "unusable": msg("cannot be started"),
    "nothing": msg("nothing handed in"),
    "failed": msg("the grader failed"),
}


@dataclass(frozen=True)
class Student:
    """One hand-in.

    Attributes:
        number: replaces the name where names are hidden, and reveals nothing of it.
        entry: the graded hand-in.
        id, name: safe to show.
        thumb: its picture and path; None where there is none.
    """

    number: int
    entry: Entry
    id: str
    name: str
    thumb: Thumb | None = field(default=None, repr=False)

    @property
    def report(self) -> str:
        """The address of its report, relative to the class page; '' where there is none."""
        if self.entry.result is None:
            return ""
        return f"{SUBMISSIONS}/{quote(self.entry.id, safe='@+')}/{Result.PAGE}"

    @property
    def status(self) -> str:
        """How its run ended, or why there was none."""
        result = self.entry.result
        if result is None:
            return translate(STATES.get(self.entry.state, NOTHING))
        outcome = clip(plain(result.run.outcome), _WORD_LIMIT).replace("_", " ")
        return outcome_text(outcome)

    @property
    def at_text(self) -> str:
        """The time of submission for people, with its zone; '' where it is unknown."""
        at = self.entry.hand_in.at
        return "" if at is None else at.isoformat(" ", "minutes")

    @property
    def late_s(self) -> float:
        """How late it was handed in [s]."""
        return 0.0 if self._handed_in is None else self._handed_in.late_s

    @property
    def late(self) -> str:
        """The lateness in words, and its deduction; '' where it was in time."""
        found = self._handed_in
        if found is None or (found.late_s <= 0 and not found.days):
            return ""
        minutes = max(int(found.late_s // 60), 1)
        days, hours = divmod(minutes // 60, 24)
        if found.late_s <= 0:
            length = tr("some time")
        elif days:
            length = tr("{days} d {hours} h", days=days, hours=hours)
        else:
            length = tr("{hours} h {minutes} min", hours=hours, minutes=minutes % 60)
        return f"{length}, −{points(found.deducted)}" if found.deducted else length

    @property
    def _handed_in(self) -> SubmissionInfo | None:
        return None if self.entry.result is None else self.entry.result.handed_in


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
        plain=shown,
    )
    return made


def students(entries: Iterable[Entry]) -> list[Student]:
    """Return all of them sorted by name; their numbers do not reveal that order."""
    listed = list(entries)
    order = sorted(listed, key=lambda entry: hashlib.sha256(entry.id.encode()).digest())
    numbers = {entry.id: number for number, entry in enumerate(order, 1)}
    made = [
        Student(numbers[entry.id], entry, _ids(entry), _safe(entry.hand_in.name) or _ids(entry))
        for entry in listed
    ]
    return sorted(made, key=lambda student: (student.name.casefold(), student.entry.id))


def evenly(chosen: Sequence[Student], most: int) -> list[Student]:
    """Return at most so many students, spread over all scores; the best first."""
    ordered = sorted(chosen, key=lambda student: (-(student.entry.score or 0.0), student.number))
    if len(ordered) <= most:
        return ordered
    return [ordered[k * len(ordered) // most] for k in range(most)]


def _ids(entry: Entry) -> str:
    return _safe(entry.hand_in.known_as) or entry.id


def _safe(name: str) -> str:
    return shown(name, _NAME_LIMIT)


# The checks of a class ----------------------------------------------------------------------------


@dataclass(frozen=True)
class CheckRow:
    """A check, over all whose submission ran.

    Attributes:
        count, passed: how many it concerned, and how many of them passed.
        mean: what they earned on average [points].
        first_line: what most of those who failed have to fix first, as one of them reads it; ''
            where nobody failed.
        alike: how many of them read the same, but for its values.
    """

    check: str
    title: Message
    max_score: float
    count: int
    passed: int
    mean: float
    first_line: str
    alike: int


def check_rows(results: Sequence[Result], points: Mapping[str, float]) -> list[CheckRow]:
    """Return a row for each check: in the exercise's order, then any others.

    Args:
        points: check -> points, of the exercise.
    """
    verdicts: dict[str, list[Verdict]] = {check: [] for check in points}
    lines: dict[str, list[_Line]] = {check: [] for check in points}
    for result in results:
        for verdict in result.verdicts:
            verdicts.setdefault(verdict.check, []).append(verdict)
            if verdict.status == "failed":
                lines.setdefault(verdict.check, []).append(_first_line(result, verdict))
    return [_row(found, lines.get(check, [])) for check, found in verdicts.items() if found]


def _row(verdicts: Sequence[Verdict], lines: Sequence[_Line]) -> CheckRow:
    first_line, alike = _most_frequent(lines)
    return CheckRow(
        check=verdicts[0].check,
        title=verdicts[0].title or Message.of(verdicts[0].check),
        max_score=verdicts[0].max_score,
        count=len(verdicts),
        passed=sum(verdict.passed for verdict in verdicts),
        mean=fmean(verdict.score for verdict in verdicts),
        first_line=first_line,
        alike=alike,
    )


def _first_line(result: Result, verdict: Verdict) -> _Line:
    """Return the first line of a report, unless that is about another check."""
    diagnosis = result.diagnosis
    if diagnosis is not None and diagnosis.check in ("", verdict.check):
        return not diagnosis.check, diagnosis.cause
    return False, verdict.rationale


def _most_frequent(lines: Sequence[_Line]) -> tuple[str, int]:
    """Return the most frequent line and how many are alike.

    Of equals it is one of the check itself, and of those the first by alphabet.
    """
    by_kind: dict[tuple[bool, Hashable], Counter[str]] = {}
    for is_of_run, line in lines:
        sentence = shown(translate(line), _LONGEST_LINE)
        by_kind.setdefault((is_of_run, _kind(line)), Counter())[sentence] += 1
    if not by_kind:
        return "", 0
    most = max(each.total() for each in by_kind.values())
    _, example = min(
        (is_of_run, min(each, key=lambda sentence: (-each[sentence], sentence)))
        for (is_of_run, _), each in by_kind.items()
        if each.total() == most
    )
    return example, most


def _kind(line: Message) -> Hashable:
    """Return what is the same in lines that differ in their values alone: times, places, names."""
    if line.text is not None:
        return line.text
    if line.is_row:
        return tuple(_kind(p) if isinstance(p, Message) else p for p in line.values.values())
    return line.key
