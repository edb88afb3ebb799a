"""The difference between two judgements of a class: who changes, by how much, and why."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from grader.batch.entry import Entry
from grader.batch.pool import Task
from grader.exercise.exercise import Exercise
from grader.exercise.verdict import Verdict
from grader.message import Message
from grader.reports.wording import points, title_of
from grader.translations import tr, tr_many, translate

#: Differences below this come from rounding [points].
NO_CHANGE = 0.005


@dataclass(frozen=True)
class Difference:
    """A check with different verdicts in two judgements.

    Attributes:
        check: its name; '' for what is deducted from the whole.
        title: its title for students.
        before, after: the verdicts; None where the exercise did not have, or no longer has, it.
        points: the change [points].
        why: a sentence.
    """

    check: str
    title: str
    before: Verdict | None
    after: Verdict | None
    points: float
    why: str


@dataclass(frozen=True)
class ChangedEntry:
    """A hand-in that gets other points, or another verdict.

    Attributes:
        before, after: its entry as it is and as it would be.
        differences: the checks that have changed.
    """

    before: Entry
    after: Entry
    differences: tuple[Difference, ...]

    @property
    def points(self) -> float:
        """The change in the gradebook [points]."""
        return round((self.after.score or 0.0) - (self.before.score or 0.0), 2)


@dataclass(frozen=True)
class Failure:
    """A hand-in that could not be judged again; it stays as it is."""

    entry: Entry
    why: Message


@dataclass(frozen=True)
class OfCheck:
    """The changes of a check over the class.

    Attributes:
        gain, lose: how many get more points for it, or fewer; others get another verdict only.
        points: the sum of all changes [points].
    """

    check: str
    title: str
    gain: int
    lose: int
    points: float


@dataclass(frozen=True)
class Regrade:
    """The changes that an exercise would make in a class.

    Attributes:
        out: the folder of the class.
        exercise: the one that it is judged by again.
        entries: all of the class, as they are.
        changes: changed points or verdicts, the largest first.
        reworded: hand-ins with other rationales for the same points.
        failures: hand-ins that could not be judged again.
        judged: how many were judged again.
        notes: other sentences for the teacher.
        made: the tasks with the new files, if the regrade is to be applied.
    """

    out: Path
    exercise: Exercise
    entries: tuple[Entry, ...]
    changes: tuple[ChangedEntry, ...]
    reworded: tuple[ChangedEntry, ...]
    failures: tuple[Failure, ...]
    judged: int
    notes: tuple[Message, ...]
    made: tuple[Task, ...] = ()

    @property
    def headline(self) -> str:
        """The result in a line: '7 of 312 change: 2 get more points, 5 get fewer points.'."""
        total = len(self.entries)
        if not self.changes:
            return tr("None of {total} changes.", total=total)
        more = sum(change.points >= NO_CHANGE for change in self.changes)
        less = sum(change.points <= -NO_CHANGE for change in self.changes)
        same = len(self.changes) - more - less
        counts = [
            tr("{number} get more points", number=more) if more else "",
            tr("{number} get fewer points", number=less) if less else "",
            tr("{number} keep theirs by other verdicts", number=same) if same else "",
        ]
        return tr_many(
            "{n} of {total} changes: {counts}.",
            "{n} of {total} change: {counts}.",
            len(self.changes),
            total=total,
            counts=", ".join(filter(None, counts)),
        )

    @property
    def more_notes(self) -> list[str]:
        """The notes, and those that follow from the numbers."""
        found = list(map(translate, self.notes))
        worth = sorted({entry.max_score for entry in self.entries} - {self.exercise.max_score})
        if worth:
            before, *more = map(points, worth)
            for other in more:
                before = tr("{one} or {other}", one=before, other=other)
            now = points(self.exercise.max_score)
            found.append(
                tr("The exercise is worth {now} points; it was {before}.", now=now, before=before)
            )
        if self.reworded:
            reworded = tr_many(
                "Of {n:,} more hand-in something else is said, for the same points.",
                "Of {n:,} more hand-ins something else is said, for the same points.",
                len(self.reworded),
            )
            found.append(reworded)
        unjudged = len(self.entries) - self.judged - len(self.failures)
        if unjudged:
            stay = tr_many(
                "{n:,} hand-in without a run stay as they are.",
                "{n:,} hand-ins without a run stay as they are.",
                unjudged,
            )
            found.append(stay)
        return found

    @cached_property
    def of_checks(self) -> list[OfCheck]:
        """The checks that change anything; those that concern the most hand-ins first."""
        found: dict[str, list[Difference]] = {}
        for change in self.changes:
            for each in change.differences:
                found.setdefault(each.check, []).append(each)
        made = [
            OfCheck(
                name,
                each[0].title,
                sum(one.points >= NO_CHANGE for one in each),
                sum(one.points <= -NO_CHANGE for one in each),
                round(sum(one.points for one in each), 2),
            )
            for name, each in found.items()
        ]
        return sorted(made, key=lambda one: (-one.gain - one.lose, -abs(one.points), one.check))


def compared(before: Entry, after: Entry) -> ChangedEntry | None:
    """Return the changes of a judged hand-in; None where there are none."""
    differences = tuple(_of_checks(before, after))
    # what is deducted from the score, e.g. for being late
    then, now = (
        0.0 if entry.result is None else entry.result.score - (entry.score or 0.0)
        for entry in (before, after)
    )
    if abs(now - then) >= NO_CHANGE:
        why = tr(
            "{now} points are deducted from the score, not {before}",
            now=points(now),
            before=points(then),
        )
        late = Difference("", tr("Handed in late"), None, None, round(then - now, 2), why)
        differences = (*differences, late)
    return ChangedEntry(before, after, differences) if differences else None


def is_of_words(change: ChangedEntry) -> bool:
    """Whether only rationales differ, and no points or verdicts."""
    return all(
        each.before is not None
        and each.after is not None
        and each.before.status == each.after.status
        and abs(each.points) < NO_CHANGE
        for each in change.differences
    )


def _of_checks(before: Entry, after: Entry) -> Iterable[Difference]:
    old, new = before.verdicts, after.verdicts
    for name in [*new, *(name for name in old if name not in new)]:
        was, is_ = old.get(name), new.get(name)
        if was is None or is_ is None or _visible(was) != _visible(is_):
            some = is_ or was
            assert some is not None
            gained = round((is_.score if is_ else 0.0) - (was.score if was else 0.0), 2)
            yield Difference(name, title_of(some), was, is_, gained, _why(was, is_))


def _visible(verdict: Verdict) -> tuple[object, ...]:
    """Return what of a verdict matters to a student; evidence follows the rationale."""
    return verdict.status, round(verdict.score, 2), verdict.rationale


def _why(was: Verdict | None, is_: Verdict | None) -> str:
    if is_ is None:
        return tr("It is no longer asked for.")
    if was is None:
        return tr("It was not asked for before. {rationale}", rationale=is_.rationale)
    if (was.status, was.rationale) == (is_.status, is_.rationale):
        return tr(
            "It is worth {now} points, not {before}. {rationale}",
            now=points(is_.max_score),
            before=points(was.max_score),
            rationale=is_.rationale,
        )
    return translate(is_.rationale)
