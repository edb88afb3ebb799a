"""What a gradebook says of one person: a member of a group has a grade of his own."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from grader.batch.entry import Entry, Person
from grader.batch.find.joining import UNCLEAR
from grader.batch.gradebook import known
from grader.reports.wording import points
from grader.translations import tr

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
        is_double: another hand-in of the same person counts, or it is not known which does.
    """

    person: Person
    entry: Entry
    final: float | None
    is_double: bool = False

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
        nothing_is_zero: whether who has handed in nothing has 0 points, or no grade at all.
    """
    found = []
    for entry in entries:
        has_none = entry.state == "nothing" and not nothing_is_zero
        final = None if has_none or entry.hand_in.problem == UNCLEAR else entry.score
        found += [Grade(person, entry, final) for person in entry.hand_in.people]
    return _one_each(found)


def _one_each(grades: list[Grade]) -> list[Grade]:
    """The same, where of one whom a course system knows once no second has points.

    What was handed in goes before what was not, then the newer before the older. Where that is not
    known none counts.
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
    """Which of one person's counts; None where nothing tells."""
    there = [number for number in numbers if grades[number].entry.state != "nothing"]
    if len(there) < 2:
        return next(iter(there or numbers))
    times = {number: grades[number].entry.hand_in.at for number in there}
    known_times = [at for at in times.values() if at is not None]
    if len(known_times) < len(there) or known_times.count(max(known_times)) > 1:
        return None
    return next(number for number, at in times.items() if at == max(known_times))


def decimal(value: float | None) -> str:
    """Points with two decimals and a point, which every course system reads; '' for None."""
    return "" if value is None else f"{value + 0.0:.2f}"


def out_of(value: float, of: float) -> str:
    """Points for people: '12.5 of 30'."""
    return tr("{score} of {max_score}", score=points(value), max_score=points(of))
