"""Grade a class on a Dask cluster: `grader batch --scheduler ADDRESS`.

Each worker of the cluster has the grader installed, as this machine has; nothing else is shared
with it, no folder and no file. All tasks are graded at one level of isolation: a worker that cannot
offer it is reported and gets no task. The scheduler gives a task that was lost with a worker to
another one. When the scheduler itself goes, all unfinished tasks are given to the next one that
answers at its address.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from itertools import chain
from typing import TYPE_CHECKING, Any, NamedTuple

from grader.batch import pool, remote
from grader.batch.class_file import OfCluster
from grader.batch.pool import Answer, Done, Task
from grader.batch.store import installed_versions
from grader.errors import UsageError
from grader.message import Message, msg, msg_many
from grader.requirements import require

if TYPE_CHECKING:
    from distributed import Client, Future

#: How long to wait for a scheduler, at first and after it was lost [s].
FIRST_S, AGAIN_S = 30.0, 600.0
#: How often in a row, with no task done between, a scheduler may be lost.
MOST_LOSSES = 3
#: How often a task is moved to other workers, because its own are gone or not fit.
MOST_MOVES = 3
#: How many more tasks are underway than the cluster has threads, so that no thread is idle.
AHEAD = 2
#: Of all that is underway [bytes]: the scheduler holds it in memory.
MOST_BYTES = 1_000_000_000
#: How long the transfer of an answer may take before it is tried again later [s].
FETCH_S = 60.0
#: Between two polls of the scheduler [s].
POLL_S = 1.0
ADVICE = msg("Install the same there as where the class is")

Notify = Callable[[Message], None]


def work(
    tasks: Iterable[Task], address: str, notify: Notify, isolation: OfCluster
) -> Iterator[Done]:
    """Do tasks on a cluster; yield each as soon as it is over.

    The next task is drawn from the iterable when there is room for it. What is underway when the
    iterator ends is cancelled: a task that runs already is finished by its worker, and dropped.

    Args:
        address: of the scheduler, in the form that Dask expects.
        notify: called with messages about the cluster, for people.
        isolation: the level at which all workers grade.

    Raises:
        UsageError: there is no scheduler, or a worker is not fit to grade this class.
    """
    require("distributed", load=False)
    waiting, losses, patience_s = iter(tasks), 0, FIRST_S
    while True:
        with _connected(address, patience_s) as client:
            session = _Session(client, waiting, isolation, notify)
            try:
                for done in session.work():
                    losses = 0
                    yield done
                return
            except _SchedulerLost as lost:
                losses += 1
                if losses > MOST_LOSSES:
                    raise UsageError(
                        "the scheduler at {address} goes again and again: {why}",
                        address=address,
                        why=lost.args[0],
                    ) from None
                waiting = chain(session.unfinished(), waiting)
            finally:
                session.cancel()
        notify(
            msg(
                "The scheduler at {address} is gone. Waiting for it, {minutes:g} minutes ...",
                address=address,
                minutes=AGAIN_S / 60,
            )
        )
        patience_s = AGAIN_S


class _SchedulerLost(Exception):
    """The connection to the scheduler is lost, and all tasks that are underway with it."""


@contextmanager
def _connected(address: str, patience_s: float) -> Iterator[Client]:
    """Yield a client of a scheduler.

    Raises:
        UsageError: there is no scheduler.
    """
    from distributed import Client

    end = time.monotonic() + patience_s
    while True:
        left_s = max(1.0, end - time.monotonic())
        try:
            client = Client(address, timeout=left_s)
            break
        except OSError as error:  # also if the scheduler ends right after it was reached
            if time.monotonic() > end:
                raise UsageError(
                    "there is no scheduler at {address}: {why}", address=address, why=str(error)
                ) from None
        except (ValueError, TypeError, RuntimeError) as error:
            raise UsageError(
                "{address} is no address of a scheduler: {why}", address=address, why=str(error)
            ) from None
        time.sleep(POLL_S)
    try:
        yield client
    finally:
        with suppress(OSError, TimeoutError):
            client.close()


class _Underway(NamedTuple):
    """A task that was given to the scheduler.

    Attributes:
        size: of its package [bytes].
        to: the workers that may have it; None: any.
    """

    task: Task
    size: int
    to: list[str] | None


class _Session:
    """Tasks on one scheduler, while the connection to it lasts."""

    def __init__(
        self, client: Client, waiting: Iterator[Task], isolation: OfCluster, notify: Notify
    ) -> None:
        self._client, self._waiting = client, waiting
        self._isolation, self._notify = isolation, notify
        self._underway: dict[Future, _Underway] = {}
        #: address -> why it gets no task
        self._unfit: dict[str, Message] = {}
        self._moved: list[Task] = []
        #: by key of a task
        self._moves: Counter[str] = Counter()
        self._has_workers = True
        self._here = pool.Process()

    def work(self) -> Iterator[Done]:
        """Do tasks; yield each as soon as it is over.

        Raises:
            _SchedulerLost: the scheduler is gone; the rest is `unfinished`.
            UsageError: a worker is not fit.
        """
        self._check_workers()
        while True:
            yield from self._fill()
            if not self._underway:
                return
            yield from self._collect()

    def unfinished(self) -> list[Task]:
        """Return the tasks that were given to this scheduler and are not done."""
        return [*(each.task for each in self._underway.values()), *self._moved]

    def cancel(self) -> None:
        """Cancel everything that is underway."""
        self._here.stop()
        self._here.end()
        if self._underway and self._client.status == "running":
            with suppress(Exception):  # then there is no scheduler to cancel it
                self._client.cancel(list(self._underway))
        self._underway.clear()

    def _check_workers(self) -> None:
        """Refuse a cluster that may reach other verdicts, before any task is sent to it."""
        level = self._isolation.level
        found = self._ask(lambda: self._client.run(remote.offer, level, on_error="return"))
        wanted = installed_versions()
        offers: dict[str, remote.Offer] = {}
        for address, theirs in found.items():
            worker = msg("the worker at {address}", address=address)
            if isinstance(theirs, remote.Offer):
                remote.check_versions(wanted, theirs.versions, worker)
                offers[address] = theirs
            elif not isinstance(theirs, OSError):  # it has not just gone
                raise _cannot_grade(worker, theirs)
        self._isolation.choose(each.isolation for each in offers.values())
        for address, theirs in offers.items():
            if theirs.isolation != self._isolation.level and not theirs.again:
                best = msg("the best there is {level!r}", level=theirs.isolation)
                self._decline(address, theirs.why or best)

    def _decline(self, address: str, why: Message) -> None:
        """Exclude a worker from getting tasks.

        Raises:
            UsageError: there is no other.
        """
        if address in self._unfit:
            return
        self._unfit[address], level = why, self._isolation.level
        self._notify(
            msg(
                "The worker at {address} takes no hand-in: this class is graded with isolation by "
                "{level} ({why}).",
                address=address,
                level=level,
                why=why,
            )
        )
        if not self._fit():
            raise self._isolation.none_offers(level)

    def _fit(self) -> list[str]:
        """Return the addresses of the workers that may get tasks."""
        return [each for each in self._ask(self._client.nthreads) if each not in self._unfit]

    def _threads(self) -> int:
        """Return how many tasks the cluster can do at once."""
        there = self._ask(self._client.nthreads)
        threads: int = sum(n for address, n in there.items() if address not in self._unfit)
        if bool(threads) != self._has_workers:
            self._has_workers = bool(threads)
            none = msg("The scheduler has no worker. Waiting for one ...")
            self._notify(msg("The scheduler has workers again.") if threads else none)
        return threads

    def _fill(self) -> Iterator[Done]:
        """Submit tasks until enough are underway; yield those that cannot be sent."""
        most = AHEAD + self._threads()
        underway = self._underway.values()
        while len(underway) < most and sum(each.size for each in underway) < MOST_BYTES:
            task = self._moved.pop() if self._moved else next(self._waiting, None)
            if task is None:
                return
            try:
                package = remote.packed(replace(task, isolation=self._isolation.level))
            except remote.Unfit:  # too large to be a submission: it is refused, not run
                yield task, self._here.done(task)
            except OSError as error:
                yield task, Answer("failed", msg("cannot be sent: {why}", why=str(error)))
            else:
                self._submit(task, package)

    def _submit(self, task: Task, package: remote.Shipment) -> None:
        import dask

        self._moved.append(task)  # until it is underway: the scheduler may go meanwhile
        quiet = {"distributed.admin.large-graph-warning-threshold": f"{2 * MOST_BYTES}B"}
        to = self._fit() if self._unfit else None  # any: also one that comes later
        with dask.config.set(quiet):
            # not pure: two equal tasks are two calls
            future = self._ask(
                lambda: self._client.submit(remote.graded, package, pure=False, workers=to)
            )
        self._underway[future] = _Underway(task, package.size, to)
        self._moved.pop()

    def _move(self, future: Future) -> Iterator[Done]:
        """Queue a task for other workers; after `MOST_MOVES` times, yield it as failed."""
        task = self._underway.pop(future).task
        self._moves[task.key] += 1
        if self._moves[task.key] > MOST_MOVES:
            yield task, Answer("failed", _lost(self._moves[task.key]))
        else:
            self._moved.append(task)

    def _move_stranded(self) -> Iterator[Done]:
        """Move the tasks whose permitted workers are all gone."""
        fit = set(self._fit()) if self._unfit else set()
        for future, each in list(self._underway.items()):
            if fit and each.to is not None and not fit & set(each.to) and not future.done():
                self._client.cancel([future])
                yield from self._move(future)

    def _collect(self) -> Iterator[Done]:
        """Wait a moment, and yield the tasks that are over."""
        from distributed import CancelledError, wait

        with suppress(TimeoutError, CancelledError):
            wait(list(self._underway), timeout=POLL_S, return_when="FIRST_COMPLETED")
        if self._client.status not in ("running", "connecting"):
            raise _SchedulerLost(msg("the connection is closed"))
        # lost: with the worker that had it, and done again elsewhere
        for future in [f for f in self._underway if f.status not in ("pending", "lost")]:
            returned = self._returned(future)
            if isinstance(returned, remote.Returned) and returned.unfit:
                self._decline(returned.unfit, returned.answer.message)
                yield from self._move(future)
            elif returned is not None:
                task = self._underway[future].task
                answer = remote.unpack(returned, task)
                del self._underway[future]
                yield task, answer
        yield from self._move_stranded()

    def _returned(self, future: Future) -> object:
        """Return what a worker returned, for `remote.unpack`; None: not there yet."""
        if future.status == "error":
            return remote.Returned(self._failure(self._ask(future.exception)))
        try:
            return future.result(timeout=FETCH_S)
        except TimeoutError:
            return None
        except Exception as error:
            if future.status in ("error", "lost", "pending"):
                return None
            raise _SchedulerLost(str(error)) from None

    def _failure(self, error: BaseException | None) -> Answer:
        if isinstance(error, UsageError):  # no task should go there
            raise error
        if isinstance(error, ImportError):
            raise _cannot_grade(msg("a worker"), error)
        from distributed import KilledWorker

        if isinstance(error, KilledWorker):
            return Answer("failed", _lost(error.allowed_failures + 1))
        what = f"{type(error).__name__}: {error}"
        return Answer("failed", msg("a worker failed: {what}", what=what))

    def _ask(self, call: Callable[[], Any]) -> Any:
        """Return what the scheduler answers.

        Raises:
            _SchedulerLost: it does not answer.
        """
        from distributed import CancelledError

        try:
            return call()
        except (OSError, CancelledError) as error:
            raise _SchedulerLost(str(error) or type(error).__name__) from None


def _lost(times: int) -> Message:
    return msg_many(
        "{n:,} worker of the cluster ended while grading it",
        "{n:,} workers of the cluster ended while grading it",
        times,
    )


def _cannot_grade(worker: Message, why: object) -> UsageError:
    return UsageError(
        "{worker} cannot grade ({why}). {advice}", worker=worker, why=str(why), advice=ADVICE
    )
