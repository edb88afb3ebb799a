"""Judge the recordings of a class again by a changed exercise: who gains, who loses; apply it.

    changes.csv     student, before, after [points]; below a check `gained` or `lost`; below `late`
                    `late`, where another deduction for lateness changes the points

It has a row for each hand-in that changes; one that could not be judged again has nothing `after`.

Nothing runs. A regrade that is applied replaces each hand-in as a whole, and class.json, which
names the exercise that the class is judged by, at the end: an interrupted call leaves every hand-in
old or new, and the same call again does the rest. The way back is a regrade by the old exercise.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from grader import Exercise, UsageError, load_exercise
from grader.exercise import View, not_followed
from grader.system import files, make_folder, remove
from grader.system import versions as system
from grader.text import Message, joined, msg, number
from grader_class import batch, pool
from grader_class.class_file import ClassFile
from grader_class.entry import Entry, entries
from grader_class.pool import Answer, Task
from grader_class.reports.csv import cell, table
from grader_class.store import STUDENTS, Store

CHANGES = "changes.csv"
#: Judging a recording again takes no longer, unless something hangs [s].
MOST_S = 600.0
#: Differences below this come from rounding [points].
_NO_CHANGE = 0.005
#: The word, and the column, of another deduction for lateness.
_LATE = "late"


@dataclass(frozen=True)
class Regrade:
    """The changes that an exercise would make in a class.

    Attributes:
        exercise: the one that it is judged by again.
        entries: all of the class, as they are.
        judged: those that were judged again, before and after.
        failures: those that could not be judged again and stay as they are, and why.
        notes: other sentences for the teacher.
        made: the tasks with the new files, if it is to be applied.
    """

    exercise: Exercise
    entries: tuple[Entry, ...]
    judged: tuple[tuple[Entry, Entry], ...]
    failures: tuple[tuple[Entry, Message], ...]
    notes: tuple[Message, ...]
    made: tuple[Task, ...]

    @property
    def headline(self) -> Message:
        changed = [pair for pair in self.judged if words_of(*pair)]
        differences = [(after.score or 0.0) - (before.score or 0.0) for before, after in changed]
        return msg(
            "{changed} of {total} change: {more} get more points, {fewer} get fewer points.",
            changed=len(changed),
            total=len(self.entries),
            more=sum(difference > _NO_CHANGE for difference in differences),
            fewer=sum(difference < -_NO_CHANGE for difference in differences),
        )

    @property
    def table(self) -> str:
        words = {before.id: words_of(before, after) for before, after in self.judged}
        removed = (check for each in words.values() for check in each)
        checks = [*dict.fromkeys((*self.exercise.points, *removed, _LATE))]
        rows: list[list[object]] = [["student", "before", "after", *map(cell, checks)]]
        for before, after in self.judged:
            if own := words[before.id]:
                scores = [number(before.score or 0.0), number(after.score or 0.0)]
                rows.append([cell(before.id), *scores, *(own.get(check, "") for check in checks)])
        for entry, _ in self.failures:
            rows.append([cell(entry.id), number(entry.score or 0.0), "", *[""] * len(checks)])
        return table(rows)


def words_of(before: Entry, after: Entry) -> dict[str, str]:
    """Return the words of a hand-in: check -> `gained` or `lost`; empty where nothing changes."""
    words = {}
    scores = [{n: each.score for n, each in e.verdicts.items()} for e in (before, after)]
    for check in {**scores[1], **scores[0]}:
        difference = scores[1].get(check, 0.0) - scores[0].get(check, 0.0)
        if abs(difference) > _NO_CHANGE:
            words[check] = "gained" if difference > 0 else "lost"
    then_deducted, now_deducted = (
        0.0 if entry.result is None else entry.result.score - (entry.score or 0.0)
        for entry in (before, after)
    )
    if abs(now_deducted - then_deducted) > _NO_CHANGE:
        words[_LATE] = _LATE
    return words


def regrade(out: Path, exercise_path: str, jobs: int, store: Store | None = None) -> Regrade:
    """Judge the recordings of a class by a changed exercise; the class itself is not changed.

    Args:
        out: the folder of the class.
        exercise_path: the edited exercise.yaml, or another name of an exercise.
        store: the opened class, if the regrade is to be applied: then the new files are made there.
    """
    of_class, exercise = ClassFile.read(out), load_exercise(exercise_path)
    of_class.check_exercise(out, exercise, exercise_path)
    before = {entry.id: entry for entry in entries(out)}
    batch.check_lateness((e.hand_in for e in before.values() if e.state == "judged"), exercise)
    judged: list[tuple[Entry, Entry]] = []
    failures: list[tuple[Entry, Message]] = []
    made: list[Task] = []
    with make_folder() as folder:
        tasks = (
            replace(task, into=store.new_place())
            if store
            else replace(task, into=folder / task.key, judge_only=True)
            for task in _tasks(Store(out), of_class, [*before.values()], exercise_path)
        )
        for task, answer in pool.work(tasks, jobs, MOST_S):
            for entry in (before[hand_in.id] for hand_in in task.hand_ins):
                again = _read(task, answer, entry)
                if isinstance(again, Message):
                    failures.append((entry, again))
                    remove(task.into / STUDENTS / entry.id)
                else:
                    judged.append((entry, again))
            if store is None:
                remove(task.into)
            elif answer.state == "done":
                made.append(task)
    return Regrade(
        exercise,
        tuple(before.values()),
        tuple(sorted(judged, key=lambda pair: pair[0].id)),
        tuple(sorted(failures, key=lambda failure: failure[0].id)),
        tuple(_notes(of_class, exercise, [*before.values()])),
        tuple(made),
    )


def apply(found: Regrade, store: Store, view: View = "student", assignment: str = "") -> None:
    """Write a regrade into its class; hand-ins that could not be judged stay as they are.

    Args:
        store: the one that the regrade was made in, still locked.
        view, assignment: see `grader_class.batch.write_outputs`.
    """
    for task in found.made:
        store.put(task.key, task.into)
    exercise = found.exercise
    for entry in found.entries:
        if entry.state != "judged":  # only the exercise and its points are new
            place = store.new_place()
            folder = place / STUDENTS / entry.id
            files.make_folder(folder)
            points, digest = exercise.max_score, exercise.sha256
            replace(entry, max_score=points, exercise_sha256=digest, folder=folder).put()
            store.put("", place)
    batch.write_outputs(store.out, entries(store.out), exercise, view, assignment)
    replace(ClassFile.read(store.out), exercise_sha256=exercise.sha256).put(store.out)


def _tasks(
    store: Store, of_class: ClassFile, found: Sequence[Entry], exercise_path: str
) -> Iterator[Task]:
    """Yield a task for each run of a class; `into` is not set yet."""
    by_run: defaultdict[str, list[Entry]] = defaultdict(list)
    for entry in found:
        if entry.state == "judged":
            by_run[entry.key].append(entry)
    for key, sharing in by_run.items():
        hand_ins = tuple(entry.hand_in for entry in sharing)
        yield Task(key, hand_ins, exercise_path, of_class.time, of_class.seed, store.run(key))


def _read(task: Task, answer: Answer, before: Entry) -> Entry | Message:
    """Return a hand-in as it was judged again, or why it was not."""
    if answer.state != "done":
        return answer.why
    try:
        again = Entry.read(task.into / STUDENTS / before.id)
    except UsageError as error:
        return error.message
    then, now = (each.result.run.trace_sha256 if each.result else "" for each in (before, again))
    if then != now:
        return msg(
            "its recording is not the one that its result was made of. To have it graded anew: "
            "grader batch ... --again {id}",
            id=before.id,
        )
    return again


def _notes(of_class: ClassFile, exercise: Exercise, found: Sequence[Entry]) -> Iterator[Message]:
    """Yield what else a teacher has to know, as what recordings cannot follow."""
    if len(found) < of_class.hand_ins:
        total = of_class.hand_ins
        yield msg("The class is not finished: {n} of {total}.", n=len(found), total=total)
    results = [entry.result for entry in found if entry.result is not None]
    origins = [result.provenance for result in results if result.provenance is not None]
    sentences = (not_followed(each.recorded, exercise.conditions) for each in origins)
    for sentence, times in Counter(each for told in sentences for each in told).items():
        yield msg(
            "{number} of {total}: {sentence}", number=times, total=len(results), sentence=sentence
        )
    others = {origin.judged.grader for origin in origins} - {system.grader_version()}
    if others:
        yield msg(
            "They were judged by version {then} of the grader, and are now by {now}: what changes "
            "may come from that, too.",
            then=joined(sorted(others), msg(" and ")),
            now=system.grader_version(),
        )
