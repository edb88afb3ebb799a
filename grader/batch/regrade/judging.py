"""Judge the recordings of a class again, in parallel and without running anything; apply it.

    before/N/           N = 1, 2, ...: the files that the N-th regrade has replaced
        changes.csv changes.html        what it changed, and why
        class.json gradebook.csv gradebook.jsonl
        submissions/ID/result.json entry.json      of each whose points, verdicts or words changed

The old files are kept before anything is changed. Then each hand-in is replaced as a whole, and
class.json, which names the exercise that the class is judged by, comes last: an interrupted call
leaves every hand-in old or new, and the same call again does the rest.
"""

from __future__ import annotations

import os
import shutil
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import count
from pathlib import Path

from grader import files, scratch, system
from grader.batch import batch, pool
from grader.batch.class_file import CLASS, ClassFile
from grader.batch.entry import ENTRY, SUBMISSIONS, Entry, entries
from grader.batch.pool import Answer, Task
from grader.batch.regrade import shown
from grader.batch.regrade.changes import ChangedEntry, Failure, Regrade, compared, is_of_words
from grader.batch.store import BEFORE, RECORDING, RUN, STUDENTS, Store
from grader.errors import UsageError
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.exercise.sentences import not_followed
from grader.message import Message, chained, msg, msg_many
from grader.removal import remove
from grader.result.result import RESULT
from grader.result.visible import View

#: Judging a recording again takes no longer, unless something hangs [s].
MOST_S = 600.0
#: Called with each hand-in that is done.
Notify = Callable[[Entry], None]
CHANGES_CSV, CHANGES_PAGE = "changes.csv", "changes.html"
#: Files made of all entries together, for others to read.
GRADEBOOKS = ("gradebook.csv", "gradebook.jsonl")


def regrade(
    out: Path,
    exercise_path: str,
    jobs: int,
    notify: Notify = lambda _: None,
    store: Store | None = None,
) -> Regrade:
    """Judge the recordings of a class by a changed exercise; the class itself is not changed.

    Args:
        out: the folder of the class.
        exercise_path: the edited exercise.yaml, or another name of an exercise.
        store: the opened class, if the regrade is to be applied: then the new files are made there.

    Raises:
        UsageError: it is no folder of a class, or the exercise is not that of the class.
        ExerciseError: the exercise cannot be used.
    """
    before, exercise = _of_class(out, exercise_path)
    found = entries(out)
    judged = {entry.id: entry for entry in found if entry.state == "judged"}
    changes: list[ChangedEntry] = []
    failures: list[Failure] = []
    made: list[Task] = []
    with scratch.make_folder() as place:
        asked = (
            replace(task, into=store.new_place())
            if store
            else replace(task, judge_only=True, into=place / str(number))
            for number, task in enumerate(_tasks(out, judged.values(), exercise_path))
        )
        for task, answer in pool.work(asked, jobs, MOST_S):
            for entry in (judged[hand_in.id] for hand_in in task.hand_ins):
                again = _read(task, answer, entry)
                if isinstance(again, Message):
                    failures.append(Failure(entry, again))
                    remove(task.into / STUDENTS / entry.id)
                elif change := compared(entry, again):
                    changes.append(change)
                notify(entry)
            if store is None:
                remove(task.into)
            elif answer.state == "done":
                made.append(task)
    changes.sort(key=lambda change: (-abs(change.points), change.before.id))
    failures.sort(key=lambda failure: failure.entry.id)
    return Regrade(
        out,
        exercise,
        tuple(found),
        tuple(change for change in changes if not is_of_words(change)),
        tuple(change for change in changes if is_of_words(change)),
        tuple(failures),
        len(judged) - len(failures),
        tuple(_notes(out, before, exercise, found)),
        tuple(made),
    )


def check(out: Path, exercise_path: str) -> int:
    """Check that a class can be judged again; return how many hand-ins that concerns.

    Raises:
        UsageError, ExerciseError: as `regrade`.
    """
    _of_class(out, exercise_path)
    return sum(entry.state == "judged" for entry in entries(out))


def _of_class(out: Path, exercise_path: str) -> tuple[ClassFile, Exercise]:
    before, exercise = ClassFile.read(out), load_exercise(exercise_path)
    if exercise.name != before.exercise:
        raise UsageError(
            "{out} was graded for the exercise {then!r}, and {path} is one of {now!r}: give an "
            "edited copy of that exercise's exercise.yaml",
            out=str(out),
            then=before.exercise,
            path=exercise_path,
            now=exercise.name,
        )
    return before, exercise


def _tasks(out: Path, found: Iterable[Entry], exercise_path: str) -> Iterator[Task]:
    """Yield a task for each run of a class; `into` is not set yet."""
    before, store, by_run = ClassFile.read(out), Store(out), defaultdict(list)
    for entry in found:  # its recording is in the store, else beside its result
        by_run[store.run(entry.key) if store.has(entry.key) else entry.folder].append(entry)
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


def _read(task: Task, answer: Answer, before: Entry) -> Entry | Message:
    if answer.state != "done":
        return answer.why
    try:
        again = Entry.read(task.into / STUDENTS / before.id)
    except UsageError as error:
        return error.message
    if any(then != now for then, now in zip(_traces(before), _traces(again), strict=False)):
        return msg(
            "its recording is not the one that its result was made of. To have it graded anew: "
            "grader batch ... --again {id}",
            id=before.id,
        )
    return again


def _traces(entry: Entry) -> list[str]:
    result = entry.result
    return [] if result is None else [r.trace_sha256 for r in (result.run, *result.varied_runs)]


def _notes(
    out: Path, before: ClassFile, exercise: Exercise, found: Sequence[Entry]
) -> Iterator[Message]:
    """Yield notes: which changes of the exercise recordings cannot reflect, and others."""
    if len(found) < before.hand_ins:
        yield msg_many(
            "{part} is not finished: {graded} of {n:,} hand-in.",
            "{part} is not finished: {graded} of {n:,} hand-ins.",
            before.hand_ins,
            part=str(out),
            graded=len(found),
        )
    if before.exercise_sha256 == exercise.sha256:
        yield msg("The class was graded by just this exercise.")
    results = [entry.result for entry in found if entry.result is not None]
    origins = [result.provenance for result in results if result.provenance is not None]
    counts = Counter(
        sentence
        for origin in origins
        for sentence in not_followed(origin.recorded, exercise.conditions)
    )
    for sentence, number in counts.items():
        yield msg(
            "{number} of {total}: {sentence}",
            number=number,
            total=len(results),
            sentence=sentence,
        )
    others = {origin.judged.grader for origin in origins} - {system.grader_version()}
    if others:
        yield msg(
            "They were judged by version {then} of the grader, and are now by {now}: what changes "
            "may come from that, too.",
            then=chained(sorted(others)),
            now=system.grader_version(),
        )


def apply(
    found: Regrade,
    store: Store,
    notify: Notify = lambda _: None,
    view: View = "student",
    assignment: str = "",
) -> None:
    """Write a regrade into its class; hand-ins that could not be judged stay as they are.

    Args:
        store: the one that the regrade was made in, still locked.
        view, assignment: see `grader.batch.batch.write_outputs`.

    Raises:
        UsageError: something cannot be written; the same call goes on where this one ended.
    """
    keep(found, store)
    by_id = {entry.id: entry for entry in found.entries}
    for task in found.made:
        if not store.has(task.key) and task.run is not None:  # it is in the hand-in's folder alone
            kept = task.into / RUN / RECORDING
            shutil.copytree(task.run / RECORDING, kept, symlinks=True, ignore=_special)
        store.put(task.key, task.into)
        for hand_in in task.hand_ins:
            notify(by_id[hand_in.id])
    for entry in found.entries:
        if entry.state != "judged":
            _put_unjudged(entry, found, store)
            notify(entry)
    now = replace(ClassFile.read(store.out), exercise_sha256=found.exercise.sha256)
    batch.write_outputs(store.out, entries(store.out), found.exercise, view, assignment)
    now.put(store.out)


def keep(found: Regrade, store: Store) -> Path:
    """Keep the files that are going to change in before/N, whole or not at all.

    Raises:
        UsageError: it cannot be written.
    """
    top = store.out / BEFORE
    made, numbered = store.new_place() / BEFORE, (top / str(number) for number in count(1))
    into = next(path for path in numbered if not os.path.lexists(path))
    with files.writing(top):
        for name in (CLASS, *GRADEBOOKS):
            if (store.out / name).is_file():
                files.put(made / name, (store.out / name).read_bytes())
        for change in (*found.changes, *found.reworded):
            for name in (RESULT, ENTRY):
                data = (change.before.folder / name).read_bytes()
                files.put(made / SUBMISSIONS / change.before.id / name, data)
        files.put(made / CHANGES_CSV, shown.table(found).encode("utf-8"))
        # from before/N/ to submissions/
        files.put(made / CHANGES_PAGE, shown.page(found, "../..").encode("utf-8"))
        top.mkdir(exist_ok=True)
        made.rename(into)
    return into


def _special(folder: str, names: list[str]) -> list[str]:
    """Return the names that no recording has: pipes, links, devices."""
    paths = (Path(folder, name) for name in names)
    return [p.name for p in paths if p.is_symlink() or not (p.is_dir() or p.is_file())]


def _put_unjudged(entry: Entry, found: Regrade, store: Store) -> None:
    """Update an entry without a result: only the exercise and its points are new."""
    place = store.new_place()
    folder = place / STUDENTS / entry.id
    files.make_folder(folder)
    score, digest = found.exercise.max_score, found.exercise.sha256
    replace(entry, max_score=score, exercise_sha256=digest, folder=folder).put()
    store.put("", place)
