"""The grade of one person: each member of a group has one."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from grader.reports import points
from grader.text import tr
from grader_class.entry import Entry, Person
from grader_class.find.joining import UNCLEAR
from grader_class.gradebook import known

#: The longest text in a cell [characters].
LONGEST = 300


@dataclass(frozen=True)
class Grade:
    """The grade of one person.

    Attributes:
        entry: the graded hand-in of the person, or of the group.
        final: the points for a course system; None where it must not get any: the grader failed,
            or an unmatched hand-in may belong to this person.
        is_double: another hand-in of the same person counts, or it is unknown which one does.
    """

    person: Person
    entry: Entry
    final: float | None
    is_double: bool = False

    @property
    def score(self) -> float | None:
        """The points before the deduction for being late."""
        result = self.entry.result
        return self.final if result is None or self.final is None else result.score

    @property
    def late_deduction(self) -> float:
        """The deduction for being late [points]."""
        if self.score is None or self.final is None:
            return 0.0
        return round(self.score - self.final, 2)

    @property
    def group(self) -> tuple[str, ...]:
        """The ids of the members of the group; empty for somebody who worked alone."""
        people = self.entry.hand_in.people
        return tuple(person.id for person in people) if len(people) > 1 else ()


def grades(entries: Iterable[Entry]) -> list[Grade]:
    """Return the grades of all people, in the order of the entries."""
    found = []
    for entry in entries:
        final = None if entry.hand_in.problem == UNCLEAR else entry.score
        found += [Grade(person, entry, final) for person in entry.hand_in.people]
    return _one_each(found)


def _one_each(grades: list[Grade]) -> list[Grade]:
    """Return the grades, with points in at most one of those of one person for a course system.

    A hand-in counts before none, then the newer before the older. Where the order is unknown, none
    counts.
    """
    by_key: dict[tuple[str, str], list[int]] = defaultdict(list)
    for number, grade in enumerate(grades):
        for key in known.keys(grade.person):
            by_key[key].append(number)
    doubles = set[int]()
    for numbers in by_key.values():
        if len(numbers) > 1:
            doubles |= set(numbers) - {_counting(grades, numbers)}
    return [
        replace(grade, final=None, is_double=True) if number in doubles else grade
        for number, grade in enumerate(grades)
    ]


def _counting(grades: Sequence[Grade], numbers: Sequence[int]) -> int | None:
    """Return which of one person's grades counts; None where that is unknown."""
    there = [number for number in numbers if grades[number].entry.state != "nothing"]
    if len(there) < 2:
        return next(iter(there or numbers))
    times = {number: grades[number].entry.hand_in.at for number in there}
    known_times = [at for at in times.values() if at is not None]
    if len(known_times) < len(there) or known_times.count(max(known_times)) > 1:
        return None
    return next(number for number, at in times.items() if at == max(known_times))


def decimal(value: float | None) -> str:
    """Format points with two decimals and a point, for any course system; '' for None."""
    return "" if value is None else f"{value + 0.0:.2f}"


def out_of(value: float, of: float) -> str:
    """Format points for people: '12.5 of 30'."""
    return tr("{score} of {max_score}", score=points(value), max_score=points(of))
