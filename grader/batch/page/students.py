"""The hand-ins of a class for its page: safe names, and the outcome of each in words."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final
from urllib.parse import quote

from grader import text
from grader.batch.entry import SUBMISSIONS, Entry, State
from grader.batch.page.thumb import Thumb
from grader.message import NOTHING, Message, msg
from grader.reports import wording
from grader.result.result import PAGE, SubmissionInfo
from grader.translations import tr, translate

_NAME_LIMIT, _WORD_LIMIT = 80, 40
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
        return f"{SUBMISSIONS}/{quote(self.entry.id, safe='@+')}/{PAGE}"

    @property
    def status(self) -> str:
        """How its run ended, or why there was none."""
        result = self.entry.result
        if result is None:
            return translate(STATES.get(self.entry.state, NOTHING))
        outcome = text.clip(text.plain(result.run.outcome), _WORD_LIMIT).replace("_", " ")
        return wording.outcome(outcome)

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
        if found is None or found.late_s <= 0:
            return ""
        minutes = max(int(found.late_s // 60), 1)
        days, hours = divmod(minutes // 60, 24)
        if days:
            length = tr("{days} d {hours} h", days=days, hours=hours)
        else:
            length = tr("{hours} h {minutes} min", hours=hours, minutes=minutes % 60)
        return f"{length}, −{wording.points(found.deducted)}" if found.deducted else length

    @property
    def _handed_in(self) -> SubmissionInfo | None:
        return None if self.entry.result is None else self.entry.result.handed_in


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
    return text.clip(text.one_line(text.plain(name)), _NAME_LIMIT)
