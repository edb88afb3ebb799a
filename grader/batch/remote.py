"""Grade a task on another machine: pack its files, do it there, and unpack the files it made.

Both shipments are plain data, which Dask serialises. A cluster calls `graded`. A submission's links
are sent as links: a run deals with where they lead. What was not asked for is refused when the
files come back.
"""

from __future__ import annotations

import asyncio
import os
import socket
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path, PurePosixPath
from typing import Literal, NamedTuple

from grader import files, scratch
from grader.batch import pool
from grader.batch.pool import Answer, Task
from grader.batch.store import RUN, STUDENTS, below, installed_versions
from grader.errors import GraderFailure, NotNow, UsageError
from grader.exercise import places
from grader.exercise.places import CHECKS
from grader.message import NOTHING, Message, joined, msg, reason
from grader.run.processes import levels
from grader.submission.folder import UNREADABLE

#: Limits of a shipment: bytes, and files, folders and links; both above those of a submission.
MOST_BYTES, MOST_ENTRIES = 250_000_000, 20_000
#: The folders of a shipment on the worker, below a folder for the task.
SUBMISSION, EXERCISE, STORED, MADE = map(Path, ("submission", "exercise", "stored", "made"))

_of_thread = threading.local()


class Unfit(Exception):
    """A shipment is too large; the text has the limit."""


class Shipped(NamedTuple):
    """An entry of a shipment; `data` is a file's content, or the target of a link."""

    kind: Literal["file", "program", "link", "folder"]
    data: bytes = b""


@dataclass(frozen=True)
class Shipment:
    """A task with all files that it needs.

    Attributes:
        task: with paths relative to the folder of the files.
        files: by their names in that folder; a folder comes before what is in it.
        versions: those that the worker must have, from `installed_versions`.
    """

    task: Task
    files: Mapping[str, Shipped]
    versions: Mapping[str, str] = field(default_factory=installed_versions)

    @property
    def size(self) -> int:
        """The size of its files [bytes]."""
        return sum(len(each.data) for each in self.files.values())


@dataclass(frozen=True)
class Returned:
    """How a task ended, with the files that it made.

    Attributes:
        files: by their names in the task's folder.
        unfit: the address of a worker that cannot confine submissions at the level of the class.
    """

    answer: Answer
    files: Mapping[str, Shipped] = field(default_factory=dict)
    unfit: str = ""


@dataclass(frozen=True)
class Offer:
    """The versions and the isolation of a cluster's worker.

    Attributes:
        versions: from `installed_versions`.
        isolation: the level that it offers; '' for none.
        why: why it offers no better one.
        again: whether it may offer one later.
    """

    versions: Mapping[str, str]
    isolation: str = ""
    why: Message = NOTHING
    again: bool = False


def check_versions(wanted: Mapping[str, str], found: Mapping[str, str], worker: Message) -> None:
    """Refuse a worker whose versions are not those of the machine with the class.

    Args:
        wanted, found: from `installed_versions`, where the class is and of the worker.
        worker: its name in messages.

    Raises:
        UsageError: they differ.
    """
    differences = [
        msg(
            "{name} {there}, and {here} where the class is",
            name=name,
            there=found.get(name) or msg("none"),
            here=value or msg("none"),
        )
        for name, value in wanted.items()
        if found.get(name) != value
    ]
    if differences:
        raise UsageError(
            "{worker} has other versions: {differences}. Install the same on both",
            worker=worker,
            differences=joined(differences, "; "),
        )


async def offer(level: str) -> Offer:
    """Return what this machine offers, as a worker of a cluster.

    Args:
        level: the level to offer; '': the best. See `grader.run.processes.levels`.
    """
    try:  # in a thread: the worker has more to do meanwhile
        return Offer(installed_versions(), (await asyncio.to_thread(levels.here, level)).level)
    except GraderFailure as error:
        return Offer(installed_versions(), "", error.message, isinstance(error, NotNow))


def packed(task: Task) -> Shipment:
    """Pack a task: its submission, its run if there is one and, unless installed, its exercise.

    Raises:
        Unfit: it is too large.
        OSError: one of its files cannot be read.
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
    return Shipment(sent, _read(trees))


def graded(package: Shipment) -> Returned:
    """Do a packed task in a separate process, and return what `unpack` expects.

    Raises:
        UsageError: this machine cannot grade the class; no other task should be sent here.
    """
    worker = msg("the worker {name}", name=socket.gethostname())
    check_versions(package.versions, installed_versions(), worker)
    with scratch.make_folder() as folder:
        try:
            _write(package.files, folder)
        except OSError as error:
            why = error.strerror or str(error)
            full = msg("{worker} has no room for it: {why}", worker=worker, why=why)
            return Returned(Answer("failed", full))
        task = _here(package.task, folder)
        answer = _process().done(task)
        if answer.state == "unfit":
            return Returned(answer, unfit=_address())
        try:
            return Returned(answer, _read({"": task.into}, lambda _: False))
        except Unfit as unfit:
            lost = msg("what came of it cannot be sent: {why}", why=reason(unfit))
            return Returned(Answer("failed", lost))


def unpack(returned: object, task: Task) -> Answer:
    """Write the files that `graded` returned into the task's folder; return how it ended.

    Raises:
        UsageError: it cannot be written.
    """
    if not isinstance(returned, Returned):
        why = msg("damaged: {why}", why=type(returned).__name__)
        return Answer("failed", msg("what a worker sent back cannot be used: {why}", why=why))
    asked = [RUN, *(f"{STUDENTS}/{each.id}" for each in task.hand_ins)]
    for name, sent in returned.files.items():
        path = PurePosixPath(name)
        is_asked = name in (".", STUDENTS) or any(path.is_relative_to(each) for each in asked)
        if not is_asked or ".." in path.parts or sent.kind == "link":
            return Answer("failed", msg("a worker sent back what nobody has asked for"))
    with files.writing(task.into):
        _write(returned.files, task.into)
    return returned.answer


def _here(task: Task, folder: Path) -> Task:
    """Return the task with paths on this machine."""
    assert task.path is not None
    (folder / MADE).mkdir()
    is_sent = Path(task.exercise).is_relative_to(EXERCISE)
    return replace(
        task,
        path=folder / task.path,
        exercise=str(folder / task.exercise) if is_sent else task.exercise,
        run=None if task.run is None else folder / task.run,
        into=folder / MADE,
    )


def _read(
    trees: Mapping[str, Path], is_left_out: Callable[[Path], bool] | None = None
) -> dict[str, Shipped]:
    """Read files, folders and links; name in the shipment -> entry.

    Args:
        trees: name in the shipment -> the file or folder to read.
        is_left_out: see `below`.

    Raises:
        Unfit: they are too large.
        OSError: something cannot be read.
    """
    found: dict[str, Shipped] = {}
    left = MOST_BYTES
    for tree, top in trees.items():
        for name, path in ((".", top), *below(top, is_left_out)):
            status = path.lstat()
            left -= 0 if path.is_dir() else status.st_size
            if left < 0 or len(found) >= MOST_ENTRIES:
                raise Unfit(
                    msg(
                        "it has more than {megabytes:g} MB, or more than {files:,} files",
                        megabytes=MOST_BYTES / 1e6,
                        files=MOST_ENTRIES,
                    )
                )
            where = PurePosixPath(tree, name).as_posix()
            if path.is_symlink():
                found[where] = Shipped("link", os.fsencode(path.readlink()))
            elif path.is_dir():
                found[where] = Shipped("folder")
            elif path.is_file():  # no pipe, socket or device: it would be waited for
                kind: Literal["file", "program"] = "program" if status.st_mode & 0o100 else "file"
                found[where] = Shipped(kind, path.read_bytes())
    return found


def _write(sent: Mapping[str, Shipped], folder: Path) -> None:
    """Write the entries of a shipment into a folder.

    Raises:
        OSError: something cannot be written.
    """
    for name, each in sent.items():
        path = folder / name
        try:
            if each.kind == "folder":
                path.mkdir(parents=True, exist_ok=True)
                continue
            path.parent.mkdir(parents=True, exist_ok=True)
            if each.kind == "link":
                path.symlink_to(os.fsdecode(each.data))
                continue
            path.write_bytes(each.data)
            if each.kind == "program":
                path.chmod(0o755)
        except OSError as error:  # its path may be longer here than there; a run leaves it out, too
            if error.errno not in UNREADABLE:
                raise


def _process() -> pool.Process:
    """Return the process that does the tasks of this thread of a worker.

    It is separate because a grading forks, handles signals and adopts orphans, which a worker of a
    cluster with its threads would not survive. It ends with this process.
    """
    if not hasattr(_of_thread, "process"):
        _of_thread.process = pool.Process()
    process: pool.Process = _of_thread.process
    return process


def _address() -> str:
    """Return the address of this worker in the cluster."""
    from distributed import get_worker

    return str(get_worker().address)
