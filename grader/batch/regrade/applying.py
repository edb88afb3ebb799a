"""Puts a regrade into force: every hand-in is judged anew, and what it was before is kept.

    before/N/           N = 1, 2, ...: what the N-th regrade has replaced
        changes.csv changes.html        what it changed, and why
        class.json gradebook.csv gradebook.jsonl
        submissions/ID/result.json entry.json      of each whose points, verdicts or words changed

What was before is kept before anything is changed. Then each hand-in is replaced as a whole, and
class.json, which says by what the class is judged, comes last: a call that is cut off leaves every
hand-in as it was or as it will be, and the same call again does the rest.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from grader import files
from grader.batch import outputs, pool
from grader.batch.class_file import CLASS, ClassFile
from grader.batch.entry import ENTRY, SUBMISSIONS, Entry, entries
from grader.batch.regrade import html, judging, table
from grader.batch.regrade.changes import Failure, Regrade
from grader.batch.store import BEFORE, RECORDING, RUN, STUDENTS, Store
from grader.batch.task import Task
from grader.result.result import RESULT
from grader.result.visible import View

CHANGES_CSV, CHANGES_PAGE = "changes.csv", "changes.html"
#: What is made of all entries together and told to others.
GRADEBOOKS = ("gradebook.csv", "gradebook.jsonl")


def apply(
    found: Regrade,
    store: Store,
    jobs: int,
    tell: judging.Tell = lambda _: None,
    view: View = "student",
    assignment: str = "",
) -> list[Failure]:
    """Write what a regrade has found; those who could not be judged stay as they are.

    Args:
        store: of the class, opened since before the regrade: nobody else has changed it.
        view, assignment: see `grader.batch.outputs.write`.

    Raises:
        UsageError: something cannot be written; the same call goes on where this one ended.
    """
    keep(found, store)
    failures = list(_judged_anew(found, store, jobs, tell))
    for entry in found.entries:
        if entry.state != "judged":
            _put_unjudged(entry, found, store)
            tell(entry)
    now = replace(ClassFile.read(store.out), exercise_sha256=found.exercise.sha256)
    outputs.write(store.out, entries(store.out), found.exercise, view, assignment)
    now.put(store.out)
    return failures


def keep(found: Regrade, store: Store) -> Path:
    """Keep what is going to change: before/N, whole or not at all.

    Raises:
        UsageError: it cannot be written.
    """
    top = store.out / BEFORE
    made, into = store.new_place() / BEFORE, _next(top)
    try:
        for name in (CLASS, *GRADEBOOKS):
            if (store.out / name).is_file():
                files.put(made / name, (store.out / name).read_bytes())
        for change in (*found.changes, *found.reworded):
            for name in (RESULT, ENTRY):
                data = (change.before.folder / name).read_bytes()
                files.put(made / SUBMISSIONS / change.before.id / name, data)
        files.put(made / CHANGES_CSV, table.render(found).encode("utf-8"))
        # from before/N/ to submissions/
        files.put(made / CHANGES_PAGE, html.render(found, "../..").encode("utf-8"))
        top.mkdir(exist_ok=True)
        made.rename(into)
    except OSError as error:
        raise files.cannot_write(top, error.strerror or str(error)) from None
    return into


def _next(top: Path) -> Path:
    number = 1
    while os.path.lexists(top / str(number)):
        number += 1
    return top / str(number)


def _judged_anew(found: Regrade, store: Store, jobs: int, tell: judging.Tell) -> Iterator[Failure]:
    """Judge again with pages and all, and put each hand-in into its place; those that failed."""
    left_out = {failure.entry.id for failure in found.failures}
    judged = {
        entry.id: entry
        for entry in found.entries
        if entry.state == "judged" and entry.id not in left_out
    }
    asked = (
        replace(task, into=store.new_place())
        for task in judging.tasks(store.out, judged.values(), found.exercise_path)
    )
    for task, answer in pool.work(asked, jobs, judging.MOST_S):
        if answer.state == "done":
            _keep_run(task, store)
            store.put(task.key, task.into)
        for hand_in in task.hand_ins:
            tell(judged[hand_in.id])
            if answer.state != "done":
                yield Failure(judged[hand_in.id], answer.why)


def _keep_run(task: Task, store: Store) -> None:
    """Have the recording in the store, where it may have lain with the hand-in alone."""
    if not store.has(task.key) and task.run is not None:
        kept = task.into / RUN / RECORDING
        shutil.copytree(task.run / RECORDING, kept, symlinks=True, ignore=_strange)


def _strange(folder: str, names: list[str]) -> list[str]:
    """What no recording has: pipes, links, devices."""
    paths = (Path(folder, name) for name in names)
    return [p.name for p in paths if p.is_symlink() or not (p.is_dir() or p.is_file())]


def _put_unjudged(entry: Entry, found: Regrade, store: Store) -> None:
    """Who has no result gets the new exercise's points to be had, and nothing else."""
    place = store.new_place()
    folder = place / STUDENTS / entry.id
    files.make_folder(folder)
    exercise = found.exercise
    replace(
        entry,
        max_score=exercise.max_score,
        exercise_sha256=exercise.sha256,
        folder=folder,
    ).put()
    store.put("", place)
