"""The tasks of a class on a dask cluster: `grader batch --scheduler ADDRESS`.

Each worker of the cluster has the grader installed, as this machine has; nothing else is shared
with it, no folder and no file. All are graded at one level of isolation: a worker that cannot offer
it is named and gets no task. A task that was lost with a worker is given to another one by the
scheduler. When the scheduler itself goes, everything that had not come back is given to the next
that answers at its address.
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
from grader.batch.store import own_versions
from grader.errors import UsageError
from grader.message import Message, msg, msg_many
from grader.requirements import require

if TYPE_CHECKING:
    from distributed import Client, Future

#: So long a scheduler is waited for, at first and after it was lost [s].
FIRST_S, AGAIN_S = 30.0, 600.0
#: So often in a row, with no task done between, a scheduler may be lost.
MOST_LOSSES = 3
#: So often a task goes to other workers, since those that should have it are gone or not fit.
MOST_MOVES = 3
#: So many more tasks are underway than the cluster has threads: none of them waits for the next.
AHEAD = 2
#: Of all that is underway [bytes]: the scheduler holds it in memory.
MOST_BYTES = 1_000_000_000
#: So long an answer may need from its worker to here, else we look again later [s].
FETCH_S = 60.0
LOOK_S = 1.0
ADVICE = msg("Install the same there as where the class is")

Tell = Callable[[Message], None]


def work(tasks: Iterable[Task], address: str, tell: Tell, isolation: OfCluster) -> Iterator[Done]:
    """Do tasks on a cluster; yields each as soon as it is over.

    A task is taken from the iterable when there is room for it. What is underway when the iterator
    ends is cancelled: what runs already comes to its end over there, and goes nowhere.

    Args:
        address: of the scheduler, as dask takes it.
        tell: is told what a person may want to know meanwhile.
        isolation: the level at which all workers grade.

    Raises:
        UsageError: there is no scheduler, or a worker is not fit to grade this class.
    """
    require("distributed", load=False)
    waiting, losses, patience_s = iter(tasks), 0, FIRST_S
    while True:
        with _connected(address, patience_s) as client:
            session = _Session(client, waiting, isolation, tell)
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
        tell(
            msg(
                "The scheduler at {address} is gone. Waiting for it, {minutes:g} minutes ...",
                address=address,
                minutes=AGAIN_S / 60,
            )
        )
        patience_s = AGAIN_S


class _SchedulerLost(Exception):
    """Nothing that is underway will come back."""


@contextmanager
def _connected(address: str, patience_s: float) -> Iterator[Client]:
    """A client of a scheduler.

    Raises:
        UsageError: there is none.
    """
    from distributed import Client

    end = time.monotonic() + patience_s
    while True:
        left_s = max(1.0, end - time.monotonic())
        try:
            client = Client(address, timeout=left_s)
            break
        except OSError as error:  # also of one that goes as soon as it has come
            if time.monotonic() > end:
                raise UsageError(
                    "there is no scheduler at {address}: {why}", address=address, why=str(error)
                ) from None
        except (ValueError, TypeError, RuntimeError) as error:
            raise UsageError(
                "{address} is no address of a scheduler: {why}", address=address, why=str(error)
            ) from None
        time.sleep(LOOK_S)
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
    """Tasks on one scheduler, for as long as that is there."""

    def __init__(
        self, client: Client, waiting: Iterator[Task], isolation: OfCluster, tell: Tell
    ) -> None:
        self._client, self._waiting = client, waiting
        self._isolation, self._tell = isolation, tell
        self._underway: dict[Future, _Underway] = {}
        #: address -> why it gets no task
        self._unfit: dict[str, Message] = {}
        self._moved: list[Task] = []
        #: by key of a task
        self._moves: Counter[str] = Counter()
        self._has_workers = True
        self._here = pool.Process()

    def work(self) -> Iterator[Done]:
        """Do tasks; yields each as soon as it is over.

        Raises:
            _SchedulerLost: the scheduler is gone; the rest is `unfinished`.
            UsageError: a worker is not fit.
        """
        self._check_workers()
        while True:
            yield from self._fill()
            if not self._underway:
                return
            yield from self._look()

    def unfinished(self) -> list[Task]:
        """What was given to this scheduler, and did not come back."""
        return [*(each.task for each in self._underway.values()), *self._moved]

    def cancel(self) -> None:
        """Have nothing underway any more."""
        self._here.stop()
        self._here.end()
        if self._underway and self._client.status == "running":
            with suppress(Exception):  # then there is nobody to tell it
                self._client.cancel(list(self._underway))
        self._underway.clear()

    def _check_workers(self) -> None:
        """Refuse a cluster that would come to other verdicts, before anything is sent to it."""
        level = self._isolation.level
        found = self._ask(lambda: self._client.run(remote.offer, level, on_error="return"))
        wanted = own_versions()
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
        """Give a worker no task any more.

        Raises:
            UsageError: there is no other.
        """
        if address in self._unfit:
            return
        self._unfit[address], level = why, self._isolation.level
        self._tell(
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
        """The workers that may get tasks."""
        return [each for each in self._ask(self._client.nthreads) if each not in self._unfit]

    def _threads(self) -> int:
        """How much the cluster does at once."""
        there = self._ask(self._client.nthreads)
        threads: int = sum(n for address, n in there.items() if address not in self._unfit)
        if bool(threads) != self._has_workers:
            self._has_workers = bool(threads)
            none = msg("The scheduler has no worker. Waiting for one ...")
            self._tell(msg("The scheduler has workers again.") if threads else none)
        return threads

    def _fill(self) -> Iterator[Done]:
        """Have enough tasks underway; those that cannot be sent are over at once."""
        most = AHEAD + self._threads()
        while len(self._underway) < most and self._bytes() < MOST_BYTES:
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
            # each has a name of its own: an equal task is not an equal call
            future = self._ask(
                lambda: self._client.submit(remote.graded, package, pure=False, workers=to)
            )
        self._underway[future] = _Underway(task, package.size, to)
        self._moved.pop()

    def _move(self, future: Future) -> Iterator[Done]:
        """Have a task wait for others again; after `MOST_MOVES` it is over."""
        task = self._underway.pop(future).task
        self._moves[task.key] += 1
        if self._moves[task.key] > MOST_MOVES:
            yield task, Answer("failed", _lost(self._moves[task.key]))
        else:
            self._moved.append(task)

    def _move_stranded(self) -> Iterator[Done]:
        """Move tasks of which all workers are gone that may have them."""
        fit = set(self._fit()) if self._unfit else set()
        for future, each in list(self._underway.items()):
            if fit and each.to is not None and not fit & set(each.to) and not future.done():
                self._client.cancel([future])
                yield from self._move(future)

    def _bytes(self) -> int:
        return sum(each.size for each in self._underway.values())

    def _look(self) -> Iterator[Done]:
        """Wait a moment, and take out what is over."""
        from distributed import CancelledError, wait

        with suppress(TimeoutError, CancelledError):
            wait(list(self._underway), timeout=LOOK_S, return_when="FIRST_COMPLETED")
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
        """What came of a task, for `remote.unpack`; None: look again."""
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
        """What the scheduler answers.

        Raises:
            _SchedulerLost: nothing.
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
