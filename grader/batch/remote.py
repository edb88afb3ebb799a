"""One task on another machine: everything it needs goes there, everything it made comes back.

What travels is a parcel (`grader.batch.parcel`), with task and answer as JSON in it. `graded` is
what a cluster calls.
"""

from __future__ import annotations

import asyncio
import errno
import json
import os
import socket
import threading
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from grader import files, scratch, strict_json, versions
from grader.batch import parcel, pool
from grader.batch.parcel import Unfit
from grader.batch.store import RUN, STUDENTS
from grader.batch.task import Answer, Task
from grader.errors import GraderFailure, NotNow, NotOffered, UsageError
from grader.exercise import places
from grader.exercise.places import CHECKS
from grader.language.phrase import Phrase, joined, reason, say
from grader.run.processes import levels
from grader.submission.folder import is_generated, is_junk

TASK, ANSWER, NEEDS = "task.json", "answer.json", "needs.json"
#: Where all else lies on the worker, below a folder of the task's own.
SUBMISSION, EXERCISE, STORED, MADE = map(Path, ("submission", "exercise", "stored", "made"))

#: What is wrong with a name in a parcel, and not with the disk.
_OF_NAMES = (
    *(errno.ENAMETOOLONG, errno.ENOTDIR, errno.EISDIR, errno.ENOTEMPTY),
    *(errno.EEXIST, errno.ENOENT, errno.EINVAL),
)

_of_thread = threading.local()


class Declined(NotOffered):
    """A worker of a cluster cannot confine submissions as all of the class are."""

    def __init__(self, message: str, address: str = "") -> None:
        super().__init__(message)
        self.address = address


def own_versions() -> dict[str, str]:
    """What has to be the same on all machines that grade one class."""
    return {
        "grader": versions.grader(),
        "python": versions.python(),
        "rclpy": versions.rclpy(),
        "ros_distro": versions.ros_distro(),
    }


def check_versions(wanted: Mapping[str, str], found: Mapping[str, str], worker: str) -> None:
    """Refuse to grade with others than those of whoever asks.

    Args:
        wanted, found: from `own_versions`, where the class is and of the worker.
        worker: what a message calls it.

    Raises:
        UsageError: they are not the same.
    """
    differences = [
        say(
            "{name} {there}, and {here} where the class is",
            name=name,
            there=found.get(name) or say("none"),
            here=value or say("none"),
        )
        for name, value in wanted.items()
        if found.get(name) != value
    ]
    if differences:
        raise UsageError(
            say(
                "{worker} has other versions: {differences}. Install the same on both",
                worker=worker,
                differences=joined(differences, "; "),
            )
        )


def is_offer(told: object) -> bool:
    """Whether something is what `offer` says."""
    return (
        isinstance(told, dict)
        and isinstance(told.get("versions"), dict)
        and told.get("isolation") in ("", *levels.LEVELS)
        and isinstance(told.get("why"), str)
        and isinstance(told.get("again"), bool)
    )


async def offer(level: str) -> dict[str, Any]:
    """What a worker of a cluster says of its machine: `versions`, `isolation`, and `why` not more.

    Args:
        level: the one that it should offer; '': its best. See `grader.run.processes.levels`.
    """
    told = {"versions": own_versions(), "isolation": "", "why": "", "again": False}
    try:  # in a thread: the worker has more to do meanwhile
        told["isolation"] = (await asyncio.to_thread(levels.here, level)).level
    except GraderFailure as error:
        told |= {"why": str(error.message), "again": isinstance(error, NotNow)}
    return told


def packed(task: Task) -> bytes:
    """A task with what was handed in, the run if there is one and, unless installed, the exercise.

    Raises:
        Unfit: it is too large.
        OSError: something of it cannot be read.
    """
    assert task.path is not None
    sent = replace(task, path=Path(SUBMISSION, task.path.name), into=Path(MADE))
    trees = {str(sent.path): task.path}
    if not places.is_installed(task.exercise):
        exercise = Path(task.exercise)
        # an edited copy beside its original means that one
        base = exercise.parent if (exercise.parent / CHECKS).is_file() else exercise
        trees[f"{EXERCISE}/{base.name}"] = base
        sent = replace(sent, exercise=str(EXERCISE / exercise.relative_to(base.parent)))
    if task.run is not None:
        sent = replace(sent, run=Path(STORED, RUN))
        trees[str(sent.run)] = task.run
    texts = {TASK: sent.to_line(), NEEDS: json.dumps(own_versions()).encode()}
    return parcel.pack(texts, trees, _is_left_out)


def graded(package: bytes) -> bytes:
    """Do a task that was packed, in a process of its own; returns what `unpack` takes.

    Raises:
        UsageError: this machine is not fit for it; no other task should come here either.
        Declined: the same; others may be fit.
    """
    with scratch.make_folder() as folder:
        worker = say("the worker {name}", name=Phrase(socket.gethostname()))
        try:
            texts = parcel.unpack(package, folder, "tar")
        except OSError as error:
            why = error.strerror or str(error)
            said = say("{worker} has no room for it: {why}", worker=worker, why=why)
            return parcel.pack({ANSWER: Answer("failed", said).to_line()}, {})
        needs = strict_json.loads(texts[NEEDS].decode())
        check_versions(needs, own_versions(), worker)
        task = _here(Task.from_line(texts[TASK]), folder)
        answer = _process().done(task)
        if answer.state == "unfit":
            raise Declined(answer.message, _address())
        try:
            return parcel.pack({ANSWER: answer.to_line()}, _made(task))
        except Unfit as unfit:
            why = say("what came of it cannot be sent: {why}", why=reason(unfit))
            answer = Answer("failed", why)
            return parcel.pack({ANSWER: answer.to_line()}, {})


def unpack(package: object, task: Task) -> Answer:
    """Put what `graded` has made into a task's folder; how it ended.

    Raises:
        UsageError: it cannot be written.
    """
    try:
        if not isinstance(package, bytes):
            raise Unfit(say("damaged: {why}", why=type(package).__name__))
        texts = parcel.unpack(package, task.into)
        answer = Answer.from_line(texts.get(ANSWER, b""))
    except (Unfit, ValueError) as error:
        why = reason(error)
    except OSError as error:
        why = error.strerror or str(error)
        if error.errno not in _OF_NAMES:
            raise files.cannot_write(task.into, why) from None
    else:
        return _as_asked(answer, task)
    return Answer("failed", say("what a worker sent back cannot be used: {why}", why=why))


def _as_asked(answer: Answer, task: Task) -> Answer:
    """The answer; a failure where more lies in the task's folder than was asked for."""
    expected = {RUN, *(f"{STUDENTS}/{each.id}" for each in task.hand_ins)}
    if answer.state == "done" and not _names(task.into) <= expected:
        return Answer("failed", say("a worker sent back what nobody has asked for"))
    return answer


def _here(task: Task, folder: Path) -> Task:
    """The same task with the places of this machine."""
    (folder / MADE).mkdir()
    is_sent = Path(task.exercise).is_relative_to(EXERCISE)
    return replace(
        task,
        path=None if task.path is None else folder / task.path,
        exercise=str(folder / task.exercise) if is_sent else task.exercise,
        run=None if task.run is None else folder / task.run,
        into=folder / MADE,
    )


def _is_left_out(path: Path) -> bool:
    """Whether something is neither handed in nor part of an exercise, as far as a run sees."""
    if is_junk(path.name):
        return True
    if os.path.islink(path):  # noqa: PTH114  where the path is too long, it is none
        return False
    return not os.access(path, os.R_OK) or (path.is_dir() and is_generated(path))


def _process() -> pool.Process:
    """The process that does the tasks of this thread of a worker.

    Of its own, because a grading forks, handles signals and adopts orphans, and a worker of a
    cluster has threads that know nothing of that. It ends when this process does.
    """
    if not hasattr(_of_thread, "process"):
        _of_thread.process = pool.Process()
    process: pool.Process = _of_thread.process
    return process


def _address() -> str:
    """What the cluster calls this worker."""
    from distributed import get_worker

    return str(get_worker().address)


def _made(task: Task) -> dict[str, Path]:
    return {name: task.into / name for name in sorted(_names(task.into))}


def _names(into: Path) -> set[str]:
    """What is in a task's folder: the run, and each student's folder."""
    students = {f"{STUDENTS}/{path.name}" for path in into.glob(f"{STUDENTS}/*")}
    return students | {path.name for path in into.iterdir() if path.name != STUDENTS}
