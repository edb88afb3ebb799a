"""What a gradebook says of one person: a member of a group has a grade of his own."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from grader.batch.entry import Entry
from grader.batch.find.joining import UNCLEAR
from grader.batch.hand_in import Person
from grader.text import points

#: The longest text in a cell [characters].
LONGEST = 300


@dataclass(frozen=True)
class Grade:
    """One person's.

    Attributes:
        person: whose.
        entry: what he, or his group, has handed in.
        final: what a course system gets [points]; None where it must not get anything: the grader
            failed, nothing was handed in and that is not to count as 0, or somebody's hand-in may
            be his.
    """

    person: Person
    entry: Entry
    final: float | None

    @property
    def score(self) -> float | None:
        """Before anything is deducted for being late [points]."""
        result = self.entry.result
        return self.final if result is None or self.final is None else result.score

    @property
    def late_deduction(self) -> float:
        """What being late has cost [points]."""
        if self.score is None or self.final is None:
            return 0.0
        return round(self.score - self.final, 2)

    @property
    def group(self) -> tuple[str, ...]:
        """The ids of all who share it; nobody where one has worked alone."""
        people = self.entry.hand_in.people
        return tuple(person.id for person in people) if len(people) > 1 else ()


def grades(entries: Iterable[Entry], nothing_is_zero: bool = True) -> list[Grade]:
    """Everybody's, by hand-in.

    Args:
        nothing_is_zero: whether who has handed in nothing has 0 points, or no grade at all. What
            was handed in and cannot be started has 0 in any case; what the grader failed to judge,
            none.
    """
    found = []
    for entry in entries:
        has_none = entry.state == "nothing" and not nothing_is_zero
        has_none = has_none or entry.hand_in.problem == UNCLEAR
        final = None if has_none else entry.score
        found += [Grade(person, entry, final) for person in entry.hand_in.people]
    return found


def decimal(value: float | None) -> str:
    """Points with two decimals and a point, which every course system reads; '' for None."""
    return "" if value is None else f"{value + 0.0:.2f}"


def out_of(value: float, of: float) -> str:
    """Points for people: '12.5 of 30'."""
    return f"{points(value)} of {points(of)}"
