"""One task: run what was handed in, unless that was done; judge it for everybody who handed it in.

Everything comes into the task's own folder. A worker does this (`grader.batch.worker`), on this
machine or on another one.
"""

from __future__ import annotations

import os
import shutil
from contextlib import ExitStack
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

from grader import files, grading, judging, scratch
from grader.batch.entry import Entry
from grader.batch.find.joining import NOTHING, UNCLEAR
from grader.batch.hand_in import HandIn
from grader.batch.page.thumb import THUMB, thumb
from grader.batch.similar import behaviour, sources
from grader.batch.store import ERROR, RECORDING, RUN, STUDENTS
from grader.batch.task import Task
from grader.errors import RecordingError, SubmissionError, UsageError
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.recording.recording import Recordings
from grader.reports import Report, render
from grader.result import json_file
from grader.result.error import ErrorResult
from grader.result.handed_in import HandedIn
from grader.result.result import ARTIFACTS, PAGE, RESULT, Result
from grader.run.opening import open_submission
from grader.submission.opening import Submission
from grader.text import plain_phrase

#: Where a student's traceback says that the hand-in lies.
SHOWN = "/submission"


def make(task: Task) -> None:
    """Fill a task's folder.

    Raises:
        GraderFailure: a run could not be made.
        CheckFailed: the exercise's code failed.
        UsageError: something cannot be written.
        RecordingError: the run that is said to be there cannot be read.
    """
    exercise = _exercise(task.exercise)
    found = _loaded(task) or _run(task, exercise)
    for hand_in in task.hand_ins:
        folder = task.into / STUDENTS / hand_in.id
        files.make_folder(folder)
        if isinstance(found, Recordings):
            _judge(found, exercise, hand_in, task, folder)
        else:
            _refuse(found, exercise, hand_in, task.key, folder)


@lru_cache(maxsize=1)
def _exercise(name_or_path: str) -> Exercise:
    """Loaded once for all tasks of a worker: that takes a third of the time of judging."""
    return load_exercise(name_or_path)


def nothing(hand_in: HandIn, exercise: Exercise, folder: Path) -> None:
    """Fill the folder of somebody who has handed in nothing that can be graded."""
    files.make_folder(folder)
    state = "nothing" if hand_in.problem in (NOTHING, UNCLEAR) else "unusable"
    _entry(hand_in, exercise, folder, state, message=hand_in.problem).put()


def failed(hand_in: HandIn, exercise: Exercise, folder: Path, message: str) -> None:
    """Fill the folder of somebody whose hand-in the grader could not judge."""
    files.make_folder(folder)
    _entry(hand_in, exercise, folder, "failed", message=plain_phrase(message)).put()


def _run(task: Task, exercise: Exercise) -> Recordings | str:
    """What a run has left, which is saved; or why there is nothing to run."""
    place = task.into / RUN
    files.make_folder(place)
    try:
        with ExitStack() as held:
            path = handed_in = task.path
            assert handed_in is not None and path is not None
            if path.is_file():  # under its own name, and without its neighbours, who are others'
                name = task.filename or path.name
                path = held.enter_context(scratch.make_folder()) / name
                shutil.copyfile(handed_in, path)
            opened = held.enter_context(open_submission(path, **exercise.opening))
            submission = _without_place(opened)
            runner = grading.runner(exercise, task.time)
            recordings = grading.run_all(submission, exercise, runner, seed=task.seed)
            _look_at(submission, recordings, place)
    except (SubmissionError, UsageError) as error:
        told = ErrorResult.of(error, exercise.max_score)
        files.put(place / ERROR, json_file.text(told.to_json()).encode())
        return told.message
    judging.save_recordings(recordings, place / RECORDING)
    return recordings


def _look_at(submission: Submission, recordings: Recordings, place: Path) -> None:
    """Keep what the pages of a whole class need to know of a run: they open no recording."""
    copy = submission.copy
    left_out = 0 if copy is None else sources.keep(copy.folder, place / sources.SOURCE)
    nominal = recordings.nominal
    files.put(place / THUMB, thumb(recordings))
    files.put(place / behaviour.NAME, behaviour.behaved(place / sources.SOURCE, nominal, left_out))


def _without_place(submission: Submission) -> Submission:
    """The same, but that nothing tells where it was handed in.

    That may be the folder of another student who has handed in the same; and it is another one on
    each machine, or each time that an archive is unpacked.
    """
    copy = submission.copy
    if copy is None:
        return submission
    return replace(submission, copy=replace(copy, prefix=str(copy.folder), shown=SHOWN))


def _loaded(task: Task) -> Recordings | str | None:
    """What an earlier run has left; None where that is nothing, or nothing that can be read.

    Raises:
        RecordingError, UsageError: it cannot be read, and there is nothing to run instead.
    """
    if task.run is None:
        return None
    error = task.run / ERROR
    try:
        if os.path.lexists(error):
            data = json_file.read(error, is_ours=True)
            return json_file.made(ErrorResult.from_json, error, data).message
        return judging.load_recordings(task.run / RECORDING)
    except (RecordingError, UsageError):
        if task.path is None:
            raise
        return None


def _judge(
    recordings: Recordings, exercise: Exercise, hand_in: HandIn, task: Task, folder: Path
) -> None:
    """Everything about a student; the recording itself is linked when it comes to its place."""
    result = judging.judge(recordings, exercise, submission=hand_in.name)
    whose = HandedIn.of(hand_in.id, hand_in.name, hand_in.attempt, hand_in.at, exercise.late)
    result = replace(result, artifacts=dict(ARTIFACTS), handed_in=whose)
    result.put(folder / RESULT)
    if not task.judge_only:
        _show(recordings, result, folder)
    _entry(hand_in, exercise, folder, "judged", task.key).put()


def _show(recordings: Recordings, result: Result, folder: Path) -> None:
    """What people look at."""
    nominal = recordings.nominal
    files.put(folder / ARTIFACTS["canvas"], nominal.png["window"])
    files.put(folder / ARTIFACTS["output"], nominal.output.encode("utf-8", "replace"))
    page = render("html", [Report.of(result, folder, recordings, "whole")])
    files.put(folder / PAGE, page.encode("utf-8"))


def _refuse(message: str, exercise: Exercise, hand_in: HandIn, key: str, folder: Path) -> None:
    _entry(hand_in, exercise, folder, "unusable", key, message).put()


def _entry(
    hand_in: HandIn, exercise: Exercise, folder: Path, state: str, key: str = "", message: str = ""
) -> Entry:
    return Entry(
        hand_in,
        state,  # type: ignore[arg-type]
        exercise.max_score,
        key,
        message,
        exercise.sha256,
        folder=folder,
    )
