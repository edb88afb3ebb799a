"""One task: run what was handed in, unless that was done; judge it for everybody who handed it in.

Everything comes into the task's own folder. A worker does this (`grader.batch.pool`), on this
machine or on another one.
"""

from __future__ import annotations

import errno
import os
import queue
import shutil
import sys
import threading
import traceback
from contextlib import ExitStack
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import IO

from grader import files, grading, judging, scratch, strict_json
from grader.batch.entry import Entry, HandIn, State
from grader.batch.find.joining import NOT_HANDED_IN, UNCLEAR
from grader.batch.page.thumb import THUMB, thumb
from grader.batch.pool import Answer, Ending, Task
from grader.batch.similar import behaviour, sources
from grader.batch.store import ERROR, RECORDING, RUN, STUDENTS
from grader.errors import (
    CheckFailed,
    GraderError,
    NotNow,
    NotOffered,
    RecordingError,
    SubmissionError,
    UsageError,
)
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.message import NOTHING, Message, msg
from grader.recording.recording import Recordings
from grader.reports import Report, render
from grader.result import json_file
from grader.result.error import ErrorResult
from grader.result.result import PAGE, RESULT, Result, SubmissionInfo, artifacts, put_artifacts
from grader.run.opening import open_submission
from grader.run.processes import levels, started_process
from grader.submission.start import Submission
from grader.text import plain
from grader.translations import use

#: Where a student's traceback says that the hand-in lies.
SHOWN = "/submission"
#: What a process may have run out of: another one, or the same a little later, may have it.
SCARCE = (errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.EAGAIN)
#: How a task ends with an error, the first that fits.
_STATES: dict[type[GraderError], Ending] = {
    CheckFailed: "exercise",
    NotOffered: "unfit",
    NotNow: "again",
    GraderError: "failed",
}


def serve() -> None:
    """Do what is asked for on standard input, a task a line, until that ends."""
    # what anything prints by mistake must not look like an answer
    answers = os.fdopen(os.dup(1), "wb", buffering=0)
    os.dup2(2, 1)
    tasks: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(sys.stdin.buffer, tasks), daemon=True).start()
    started_process.adopt_orphans()
    while True:
        task = strict_json.of_line(Task, tasks.get())
        answers.write(strict_json.line(done(task)))


def done(task: Task) -> Answer:
    """Do a task; whatever goes wrong is an answer."""
    try:
        use(task.language)
        levels.only(task.isolation)
        make(task)
    except GraderError as error:
        state = next(state for kind, state in _STATES.items() if isinstance(error, kind))
        return Answer(state, error.message.map_texts(plain))
    except Exception as error:
        traceback.print_exc()
        what = "".join(traceback.format_exception_only(error)).strip()
        is_scarce = isinstance(error, OSError) and error.errno in SCARCE
        return Answer(
            "again" if is_scarce else "failed", msg("unexpected: {what}", what=plain(what))
        )
    return Answer("done")


def _listen(pipe: IO[bytes], tasks: queue.SimpleQueue[bytes]) -> None:
    for line in pipe:
        tasks.put(line)
    os._exit(0)


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
        if isinstance(found, Recordings):
            _judge(found, exercise, hand_in, task, folder)
        else:
            _put(hand_in, exercise, folder, "unusable", found, task.key)


@lru_cache(maxsize=1)
def _exercise(name_or_path: str) -> Exercise:
    """Loaded once for all tasks of a worker: that takes a third of the time of judging."""
    return load_exercise(name_or_path)


def nothing(hand_in: HandIn, exercise: Exercise, folder: Path) -> None:
    """Fill the folder of somebody who has handed in nothing that can be graded."""
    is_nothing = hand_in.problem in (NOT_HANDED_IN, UNCLEAR)
    _put(hand_in, exercise, folder, "nothing" if is_nothing else "unusable", hand_in.problem)


def failed(hand_in: HandIn, exercise: Exercise, folder: Path, message: Message) -> None:
    """Fill the folder of somebody whose hand-in the grader could not judge."""
    _put(hand_in, exercise, folder, "failed", message.map_texts(plain))


def _run(task: Task, exercise: Exercise) -> Recordings | Message:
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


def _loaded(task: Task) -> Recordings | Message | None:
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
    whose = SubmissionInfo.of(hand_in.id, hand_in.name, hand_in.attempt, hand_in.at, exercise.late)
    result = replace(result, artifacts=artifacts(recordings.nominal), handed_in=whose)
    files.make_folder(folder)
    result.put(folder / RESULT)
    if not task.judge_only:
        _show(recordings, result, folder)
    _put(hand_in, exercise, folder, "judged", key=task.key)


def _show(recordings: Recordings, result: Result, folder: Path) -> None:
    """What people look at."""
    put_artifacts(recordings.nominal, folder)
    page = render("html", [Report.of(result, folder, recordings, "whole")])
    files.put(folder / PAGE, page.encode("utf-8"))


def _put(
    hand_in: HandIn,
    exercise: Exercise,
    folder: Path,
    state: State,
    message: Message = NOTHING,
    key: str = "",
) -> None:
    files.make_folder(folder)
    score, digest = exercise.max_score, exercise.sha256
    Entry(hand_in, state, score, key, message, digest, folder=folder).put()
