"""Judges the recordings of a class again, in parallel, without running anything."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from grader import scratch, versions
from grader.batch import pool
from grader.batch.class_file import ClassFile
from grader.batch.entry import Entry, entries
from grader.batch.regrade.changes import Change, Failure, Regrade, compared, is_of_words
from grader.batch.store import STUDENTS, Store
from grader.batch.task import Answer, Task
from grader.errors import UsageError
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.exercise.sentences import not_followed
from grader.language.phrase import Phrase, chained, say
from grader.removal import remove

#: Judging a recording again takes no longer, unless something hangs [s].
MOST_S = 600.0
#: Told of each hand-in that is over.
Tell = Callable[[Entry], None]


def regrade(out: Path, exercise_path: str, jobs: int, tell: Tell = lambda _: None) -> Regrade:
    """Judge the recordings of a class by another state of its exercise; nothing is written.

    Args:
        out: the folder of the class.
        exercise_path: the edited exercise.yaml, or what else names an exercise.

    Raises:
        UsageError: it is no folder of a class, or the exercise is not that of the class.
        ExerciseError: the exercise cannot be used.
    """
    before, exercise = _of_class(out, exercise_path)
    found = entries(out)
    changes: list[Change] = []
    failures: list[Failure] = []
    judged = 0
    for entry, again in _judged_again(out, found, exercise_path, jobs):
        tell(entry)
        if isinstance(again, str):
            failures.append(Failure(entry, again))
            continue
        judged += 1
        change = compared(entry, again)
        if change is not None:
            changes.append(change)
    changes.sort(key=lambda change: (-abs(change.points), change.before.id))
    failures.sort(key=lambda failure: failure.entry.id)
    return Regrade(
        out,
        exercise,
        exercise_path,
        tuple(found),
        tuple(change for change in changes if not is_of_words(change)),
        tuple(change for change in changes if is_of_words(change)),
        tuple(failures),
        judged,
        tuple(_notes(out, before, exercise, found)),
    )


def check(out: Path, exercise_path: str) -> int:
    """Whether there is something to be judged again, before anything else is done: how many.

    Raises:
        UsageError, ExerciseError: as `regrade`.
    """
    _of_class(out, exercise_path)
    return sum(entry.state == "judged" for entry in entries(out))


def _of_class(out: Path, exercise_path: str) -> tuple[ClassFile, Exercise]:
    before, exercise = ClassFile.read(out), load_exercise(exercise_path)
    if exercise.name != before.exercise:
        raise UsageError(
            say(
                "{out} was graded for the exercise {then!r}, and {path} is one of {now!r}: give an "
                "edited copy of that exercise's exercise.yaml",
                out=str(out),
                then=before.exercise,
                path=exercise_path,
                now=exercise.name,
            )
        )
    return before, exercise


def tasks(out: Path, found: Iterable[Entry], exercise_path: str) -> Iterator[Task]:
    """A task for each run of a class; `into` is not set yet."""
    before, by_run = ClassFile.read(out), defaultdict(list)
    for entry in found:
        by_run[_run(out, entry)].append(entry)
    for run, sharing in by_run.items():
        yield Task(
            key=sharing[0].key,
            hand_ins=tuple(entry.hand_in for entry in sharing),
            path=None,
            filename="",
            exercise=exercise_path,
            time=before.time,
            seed=before.seed,
            run=run,
            into=Path(),
        )


def _run(out: Path, entry: Entry) -> Path:
    """Where the recording of a hand-in lies: in the store, or else beside its result."""
    store = Store(out)
    return store.run(entry.key) if store.has(entry.key) else entry.folder


def _judged_again(
    out: Path, found: Iterable[Entry], exercise_path: str, jobs: int
) -> Iterator[tuple[Entry, Entry | str]]:
    """Each judged hand-in with its new judgement, or why there is none."""
    by_id = {entry.id: entry for entry in found if entry.state == "judged"}
    with scratch.make_folder() as place:
        asked = (
            replace(task, judge_only=True, into=place / str(number))
            for number, task in enumerate(tasks(out, by_id.values(), exercise_path))
        )
        for task, answer in pool.work(asked, jobs, MOST_S):
            for hand_in in task.hand_ins:
                yield by_id[hand_in.id], _read(task, answer, by_id[hand_in.id])
            remove(task.into)


def _read(task: Task, answer: Answer, before: Entry) -> Entry | str:
    if answer.state != "done":
        return answer.why
    try:
        again = Entry.read(task.into / STUDENTS / before.id)
    except UsageError as error:
        return error.message
    if any(then != now for then, now in zip(_traces(before), _traces(again), strict=False)):
        return say(
            "its recording is not the one that its result was made of. To have it graded anew: "
            "grader batch ... --again {id}",
            id=Phrase(before.id),
        )
    return again


def _traces(entry: Entry) -> list[str]:
    result = entry.result
    return [] if result is None else [r.trace_sha256 for r in (result.run, *result.varied_runs)]


def _notes(
    out: Path, before: ClassFile, exercise: Exercise, found: Sequence[Entry]
) -> Iterator[str]:
    """What of the exercise recordings cannot follow, and what else differs."""
    yield from before.unfinished(out, len(found))
    if before.exercise_sha256 == exercise.sha256:
        yield say("The class was graded by just this exercise.")
    results = [entry.result for entry in found if entry.result is not None]
    origins = [result.provenance for result in results if result.provenance is not None]
    told = Counter(
        sentence
        for origin in origins
        for sentence in not_followed(origin.recorded, exercise.conditions)
    )
    for sentence, number in told.items():
        yield say(
            "{number} of {total}: {sentence}",
            number=number,
            total=len(results),
            sentence=sentence,
        )
    others = {origin.judged.grader for origin in origins} - {versions.grader()}
    if others:
        yield say(
            "They were judged by version {then} of the grader, and are now by {now}: what changes "
            "may come from that, too.",
            then=chained(sorted(others)),
            now=versions.grader(),
        )
