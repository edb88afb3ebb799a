"""Do one task: run a submission, unless that was done; judge it for each who handed it in.

All files are written into the task's own folder. A worker does this (`grader_class.pool`), on this
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

from grader import (
    Exercise,
    GraderError,
    Recordings,
    SubmissionError,
    UsageError,
    errors,
    judge,
    load_exercise,
    load_recordings,
    open_submission,
    record,
    save_recordings,
)
from grader.exercise import ErrorResult, SubmissionInfo, artifacts, json_file, put_artifacts
from grader.reports import Report, render
from grader.run import levels, started_process
from grader.system import files, make_folder, strict_json
from grader.text import NOTHING, Message, msg, plain, translations
from grader_class import export
from grader_class.entry import Entry, HandIn, State
from grader_class.find.joining import NOT_HANDED_IN, UNCLEAR
from grader_class.page.thumb import THUMB, thumb
from grader_class.pool import Answer, Ending, Task
from grader_class.store import ERROR, RECORDING, RUN, STUDENTS

#: The path of the submission that a student's traceback shows.
SHOWN = "/submission"
#: A process has run out of something that another one, or the same a little later, may have.
SCARCE = (errno.EMFILE, errno.ENFILE, errno.ENOMEM, errno.EAGAIN)
#: How a task ends with an error: the first class that fits.
_STATES: dict[type[GraderError], Ending] = {
    errors.CheckFailed: "exercise",
    errors.NotOffered: "unfit",
    errors.NotNow: "again",
    GraderError: "failed",
}


def serve() -> None:
    """Do the tasks on standard input, one a line, until it ends."""
    # what anything prints by mistake must not be read as an answer
    answers = os.fdopen(os.dup(1), "wb", buffering=0)
    os.dup2(2, 1)
    tasks: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(sys.stdin.buffer, tasks), daemon=True).start()
    started_process.adopt_orphans()
    while True:
        task = strict_json.of_line(Task, tasks.get())
        answers.write(strict_json.line(done(task)))


def done(task: Task) -> Answer:
    """Do a task, and return how it ended; every exception becomes an answer."""
    try:
        translations.use(task.language)
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
            "again" if is_scarce else "failed",
            msg("unexpected: {what}", what=plain(what)),
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
        RecordingError: the task names a run that cannot be read.
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
    """Load an exercise, once for all tasks of a worker: it takes a third of the time of judging."""
    return load_exercise(name_or_path)


def nothing(hand_in: HandIn, exercise: Exercise, folder: Path) -> None:
    """Fill the folder of a hand-in that cannot be graded, or that is missing."""
    is_nothing = hand_in.problem in (NOT_HANDED_IN, UNCLEAR)
    _put(hand_in, exercise, folder, "nothing" if is_nothing else "unusable", hand_in.problem)


def failed(hand_in: HandIn, exercise: Exercise, folder: Path, message: Message) -> None:
    """Fill the folder of a hand-in that the grader failed to judge."""
    _put(hand_in, exercise, folder, "failed", message.map_texts(plain))


def _run(task: Task, exercise: Exercise) -> Recordings | Message:
    """Run a submission, and save and return its recordings; or return why it cannot be started."""
    place = task.into / RUN
    files.make_folder(place)
    try:
        with ExitStack() as held:
            path = submitted = task.path
            assert submitted is not None and path is not None
            if path.is_file() or task.filename:
                # by its original name, not the export's, and apart from the files of others
                path = held.enter_context(make_folder()) / (task.filename or path.name)
                if submitted.is_file():
                    shutil.copyfile(submitted, path)
                else:
                    path.symlink_to(submitted)
            opened = held.enter_context(
                open_submission(path, task.executable, task.launch, **exercise.opening)
            )
            copy = opened.copy
            assert copy is not None  # what is opened here has a copy of its own
            # the path may be in the folder of another student who handed in the same; it differs on
            # each machine, and each time that an archive is unpacked
            shown = replace(copy, prefix=str(copy.folder), shown=SHOWN)
            submission = replace(opened, copy=shown)
            recordings = record(
                submission, exercise, time=task.time, seed=task.seed, hides_seed=task.hides_seed
            )
            # what the pages of the whole class show of a run: they open no recording
            export.keep(copy.folder, place / export.SOURCE)
            files.put(place / THUMB, thumb(recordings))
    except (SubmissionError, UsageError) as error:
        result = ErrorResult.of(error, exercise.max_score)
        files.put(place / ERROR, json_file.text(result.to_json()).encode())
        return result.message
    save_recordings(recordings, place / RECORDING)
    return recordings


def _loaded(task: Task) -> Recordings | Message | None:
    """Load an earlier run, or why there was none; None where there is nothing readable."""
    if task.run is None:
        return None
    error = task.run / ERROR
    try:
        if os.path.lexists(error):
            data = json_file.read(error, is_ours=True)
            return json_file.made(ErrorResult.from_json, error, data).message
        return load_recordings(task.run / RECORDING)
    except (errors.RecordingError, UsageError):
        if task.path is None:
            raise
        return None


def _judge(
    recordings: Recordings, exercise: Exercise, hand_in: HandIn, task: Task, folder: Path
) -> None:
    """Write the folder of a hand-in, except the recording, which `Store.put` links into it."""
    result = judge(recordings, exercise, submission=hand_in.name)
    late = exercise.late if hand_in.at is not None or hand_in.is_marked_late else None
    whose = SubmissionInfo.of(hand_in.id, hand_in.name, hand_in.attempt, hand_in.at, late)
    result = replace(result, artifacts=artifacts(recordings.nominal), handed_in=whose)
    files.make_folder(folder)
    result.put(folder)
    if not task.judge_only:
        put_artifacts(recordings.nominal, folder)
        page = render("html", [Report.of(result, folder, recordings, "whole")])
        files.put(folder / result.PAGE, page.encode("utf-8"))
    _put(hand_in, exercise, folder, "judged", key=task.key)


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
