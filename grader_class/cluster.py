"""Grade a class on a Dask cluster with a shared folder: `grader batch --scheduler ADDRESS`.

Each worker has the grader installed, as this machine has, and sees what was handed in, the exercise
and the folder of the class under the same paths. It grades as a worker of the local pool does
(`grader_class.pool`), and writes into the folder of the class itself: only the task and its answer
are sent. Dask gives the task of a worker that died to another one.
"""

from __future__ import annotations

import logging
import os
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING

from grader import UsageError, errors
from grader.run import levels
from grader.system import requirements
from grader.text import Message, joined, msg
from grader_class import class_file, pool
from grader_class.pool import Answer, Done, Task
from grader_class.store import installed_versions

if TYPE_CHECKING:
    from distributed import Client, Future

#: How long to wait for the scheduler [s].
FIRST_S = 30.0
#: How many workers may die of a task.
TRIES = 2

_of_thread = threading.local()


@dataclass(frozen=True)
class Terms:
    """What each worker must have, so that it does not matter which one grades a hand-in.

    Attributes:
        out: the folder of the class.
        place: a new folder in it, into which each must be able to write.
        inputs: what each must be able to read.
        level: at which all are isolated; '' until it is chosen.
        versions: name and version of what a run depends on.
    """

    out: Path
    place: Path
    inputs: tuple[Path, ...]
    level: str = ""
    versions: tuple[tuple[str, str], ...] = field(
        default_factory=lambda: tuple(installed_versions().items())
    )


# On the machine with the class --------------------------------------------------------------------


def work(
    tasks: Iterable[Task],
    address: str,
    terms: Terms,
    notify: Callable[[Message], None],
    least: str = "",
) -> Iterator[Done]:
    """Do tasks on a cluster; yield each as soon as it is over.

    Args:
        address: of the scheduler, in the form that Dask expects.
        notify: called with messages for people.
        least: the lowest level of isolation that may be; '' for any.
    """
    requirements.require("distributed", load=False)
    with _connected(address) as client:
        if not client.nthreads():
            notify(msg("The scheduler has no worker. Waiting for one ..."))
            client.wait_for_workers(1)
        terms = _agreed(client, terms, least)
        class_file.note(terms.out, terms.level)
        futures = {client.submit(graded, task, terms, pure=False): task for task in tasks}
        try:
            yield from _collected(futures, address)
        finally:
            with suppress(Exception):  # without a scheduler nothing is under way
                client.cancel(list(futures))  # a task that runs is finished, and dropped


@contextmanager
def _connected(address: str) -> Iterator[Client]:
    from distributed import Client

    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)  # it prints tracebacks
    try:
        client = Client(address, timeout=FIRST_S)
    except OSError as error:
        raise UsageError(
            "there is no scheduler at {address}: {why}", address=address, why=str(error)
        ) from None
    except (ValueError, TypeError, RuntimeError) as error:
        raise UsageError(
            "{address} is no address of a scheduler: {why}", address=address, why=str(error)
        ) from None
    try:
        yield client
    finally:
        with suppress(OSError, TimeoutError):
            client.close()


def _agreed(client: Client, terms: Terms, least: str) -> Terms:
    """Return the terms of all workers: at the class's level, else the best that each offers."""
    futures = {
        address: client.submit(offer, terms, workers=[address], pure=False)
        for address in client.nthreads()
    }
    offered = []
    for address, future in futures.items():
        try:
            offered.append(future.result())
        except UsageError:
            raise
        except Exception as error:
            raise _cannot_grade(msg("the worker at {address}", address=address), error) from None
    level = max(offered, key=levels.LEVELS.index)
    if least and class_file.is_less(level, least):
        raise UsageError(
            "a worker of the cluster offers isolation by {level}, and none better. To get "
            "{least}: {advice}.",
            level=level,
            least=least,
            advice=levels.ADVICE[least],
        )
    return replace(terms, level=level)


def _collected(futures: dict[Future, Task], address: str) -> Iterator[Done]:
    """Yield each task as soon as it is over, with the folder that its files are in."""
    from distributed import CancelledError, as_completed

    for future in as_completed(list(futures)):
        task = futures.pop(future)
        try:
            answer, into = future.result()
            yield replace(task, into=into), answer
        except UsageError:
            raise
        except CancelledError:
            raise UsageError(
                "the scheduler at {address} is gone. Start it again and repeat the call: what is "
                "graded is kept",
                address=address,
            ) from None
        except ImportError as error:
            raise _cannot_grade(msg("a worker"), error) from None
        except Exception as error:
            what = f"{type(error).__name__}: {error}"
            yield task, Answer("failed", msg("a worker failed: {what}", what=what))


def _cannot_grade(worker: Message, why: object) -> UsageError:
    return UsageError(
        "{worker} cannot grade ({why}). Install the same there as where the class is",
        worker=worker,
        why=str(why),
    )


# On a worker --------------------------------------------------------------------------------------


@lru_cache  # each process of a worker is asked once, also one that comes later
def offer(terms: Terms) -> str:
    """Return the level at which this worker isolates submissions."""
    from distributed import get_worker

    worker = msg("the worker at {address}", address=get_worker().address)
    mine = installed_versions()
    if differences := [
        msg(
            "{name} {there}, and {here} where the class is",
            name=name,
            there=mine.get(name) or msg("none"),
            here=value or msg("none"),
        )
        for name, value in terms.versions
        if mine.get(name) != value
    ]:
        raise UsageError(
            "{worker} has other versions: {differences}. Install the same on both",
            worker=worker,
            differences=joined(differences, "; "),
        )
    seen = [(terms.place, os.R_OK | os.W_OK), *((path, os.R_OK) for path in terms.inputs)]
    for path, mode in seen:
        if not os.access(path, mode):
            raise UsageError(
                "{worker} cannot see {path}, or not write there. Put the submissions, --out and "
                "an --exercise of your own into a folder that all machines have under the same "
                "path",
                worker=worker,
                path=str(path),
            )
    try:
        if level := levels.here(terms.level).level:
            return level
        why = msg("there is no isolation")
    except errors.GraderFailure as error:
        why = error.message
    raise UsageError(
        "{worker} cannot isolate submissions as this class asks: {why}", worker=worker, why=why
    )


def graded(task: Task, terms: Terms) -> tuple[Answer, Path]:
    """Do a task; return how it ended, and the folder with its files.

    Each try has a folder of its own: a worker that only lost its connection may still write.
    """
    offer(terms)
    tries = sum(1 for _ in task.into.iterdir())
    if tries >= TRIES:
        lost = msg("{n:,} workers of the cluster ended while grading it", n=tries)
        return Answer("failed", lost), task.into
    into = task.into / str(tries + 1)
    into.mkdir()
    return _process().done(replace(task, into=into, isolation=terms.level)), into


def _process() -> pool.Process:
    """Return the process that does the tasks of this thread; it ends with the worker.

    It is separate because a grading forks, handles signals and adopts orphans, which a worker with
    its threads would not survive.
    """
    if not hasattr(_of_thread, "process"):
        _of_thread.process = pool.Process()
    process: pool.Process = _of_thread.process
    return process
