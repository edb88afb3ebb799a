"""Started processes: reads their output, waits for their ends, and leaves nothing of them behind.

`StartedProcess` is one of our programs, which leaves nothing behind when it ends by itself;
`SubmissionProcess` is a submission's, below a supervisor that holds all its descendants, and
watched by a limits guard.
"""

from __future__ import annotations

import os
import signal
import threading
import time
import uuid
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType

import psutil

from grader.errors import GraderFailure, NotNow
from grader.run.limits import KEPT_OUTPUT_BYTES, START_S, CpuBudget
from grader.run.processes.fork_server import ForkServer, ServerLost, cold_server
from grader.run.processes.fork_server_main import MARK, ProcessCommand
from grader.run.processes.limits_guard import LimitsGuard
from grader.run.processes.refusal import Refusal
from grader.run.sandbox.confinement import SEPARATE
from grader.system import linux
from grader.text.message import NOTHING, Message, msg

#: Signals that ask the grader to end: Ctrl-C, `timeout` or `docker stop`, a closed terminal.
ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
#: How long a process may take to end after a signal [s].
PATIENCE_S = 2.0

_running: set[StartedProcess] = set()
_is_ending = threading.Event()


def adopt_orphans() -> None:
    """Become the parent of grandchildren whose parent ends, so that none of them outlives us.

    Only for a process that is the grader and nothing else: a caller of the library is not changed.
    """
    linux.control(linux.PR_SET_CHILD_SUBREAPER, 1)


def end_on_signals() -> None:
    """Have any signal of `ENDING` end all runs in good order, and then the main thread.

    The main thread gets a KeyboardInterrupt. Runs in other threads see their processes die, and
    cannot start others; when they have returned, nothing is left behind.
    """

    def end(number: int, frame: FrameType | None) -> None:
        for each in ENDING:
            signal.signal(each, signal.SIG_IGN)  # cleaning up is not to be cut short
        _is_ending.set()
        for process in list(_running):
            process.kill()
        raise KeyboardInterrupt

    for number in ENDING:
        # a signal that the caller ignores (nohup) stays ignored
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, end)


def await_ends(processes: Iterable[psutil.Process], timeout_s: float) -> list[psutil.Process]:
    """Wait for the ends of processes that are not our children; return those that still run.

    The process that has adopted one may be slow to reap it, as the first process of a container
    often is; and the first of a namespace sleeps until all others have been reaped. So a process
    without memory counts as ended.
    """
    deadline = time.monotonic() + timeout_s
    while (left := [each for each in processes if _runs(each)]) and time.monotonic() < deadline:
        time.sleep(0.005)
    return left


def _runs(process: psutil.Process) -> bool:
    with suppress(psutil.NoSuchProcess):  # also a zombie
        return process.is_running() and bool(process.cmdline())
    return False


class NotConfined(NotNow):
    """A process could not be confined or started, though that was possible before."""

    def __init__(self, refusal: Refusal) -> None:
        super().__init__(
            msg("the submission's process could not be started: {why}", why=refusal.why)
        )
        self.refusal = refusal


class StartedProcess:
    """A process in a session of its own whose output is read as it comes.

    However much it prints, only the start and the end are kept, and it never blocks on a full pipe.
    """

    #: whether a supervisor stands above it
    IS_SUPERVISED = False

    def __init__(self, command: ProcessCommand, server: ForkServer | None = None) -> None:
        """Start it.

        Args:
            server: what it is forked from, if that can be; None: it starts from nothing.
        """
        self._mark = uuid.uuid4().hex
        #: users whose processes are all its own
        self._users: set[int] = set()
        if command.confinement and command.confinement["user"] == SEPARATE:
            self._users.add(command.confinement["uid"])
        #: the server that was started for this process alone
        self._cold_server: ForkServer | None = None
        marked = command._replace(env={**command.env, MARK: self._mark})
        child = None
        if server is not None:
            with suppress(ServerLost):
                child = server.fork(marked, supervised=self.IS_SUPERVISED)
        if child is None:
            self._cold_server = cold_server(command.env)
            try:
                child = self._cold_server.fork(marked, supervised=self.IS_SUPERVISED)
            except ServerLost as lost:
                raise NotConfined(lost.refusal) from None
            finally:
                self._cold_server.retire()
        self._child, self._report = child, child.report
        self._head = bytearray()
        self._tail = bytearray()
        self._dropped = 0
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        _running.add(self)
        if _is_ending.is_set():
            self.end(gently=False)
            raise KeyboardInterrupt

    @property
    def pid(self) -> int:
        return self._child.pid

    def wait(self, timeout_s: float) -> int | None:
        """Wait for its end; return its exit code, negative for a signal, None if it still runs.

        Raises:
            NotConfined: it could not be confined, or started.
        """
        code = self._await_end(timeout_s)
        if code is not None and "refused" in self._report.facts:
            raise NotConfined(Refusal.from_line(str(self._report.facts["refused"])))
        return code

    def _await_end(self, timeout_s: float) -> int | None:
        if not self._report.await_fact("over", timeout_s):
            return None
        return int(self._report.facts.get("over", -signal.SIGKILL))

    @property
    def was_lost(self) -> bool:
        """Whether it ended only because its fork server did."""
        is_silent = self._report.is_complete and "over" not in self._report.facts
        return is_silent and self._cold_server is None

    @property
    def printed_bytes(self) -> int:
        """How much it has printed [bytes]."""
        return len(self._head) + self._dropped + len(self._tail)

    def output(self) -> str:
        """Return what it has printed: all of it, or its start and end with a note between."""
        self._reader.join(1.0)  # ends with the process, unless a grandchild keeps the pipe
        middle = f"\n[... {self._dropped} bytes left out ...]\n" if self._dropped else ""
        return (
            self._head.decode("utf-8", "replace") + middle + self._tail.decode("utf-8", "replace")
        )

    def kill(self) -> None:
        self._signal(signal.SIGKILL)

    @contextmanager
    def ended_at_exit(self, *, gently: bool = True) -> Iterator[None]:
        """End it when the context is left; see `end`."""
        try:
            yield
        finally:
            self.end(gently=gently)

    def end(self, *, gently: bool = True) -> None:
        """Ask it to end as Ctrl-C would, then kill it, with its descendants."""
        is_through = self._await_end(0.0) == 0
        self._signal_group(*(signal.SIGINT, signal.SIGTERM) if gently else (), signal.SIGKILL)
        if not is_through:
            self._sweep()
        self._forget()

    def _signal_group(self, *numbers: signal.Signals) -> None:
        """Send its group one signal after the other, for as long as it does not end."""
        for number in numbers:
            if self._await_end(0.0) is None:
                with suppress(ProcessLookupError):
                    os.killpg(self.pid, number)
                self._await_end(PATIENCE_S)

    def _forget(self) -> None:
        """Release its descriptors; it has ended, so the grader's end need not handle it."""
        _running.discard(self)
        self._report.close()
        if self._child.pidfd >= 0:
            os.close(self._child.pidfd)
            self._child = self._child._replace(pidfd=-1)
        if self._cold_server is not None:
            self._cold_server.close()

    def _signal(self, number: signal.Signals) -> None:
        """Send a signal to it, or to its supervisor."""
        with suppress(OSError):  # it has ended
            if self._child.pidfd >= 0:
                signal.pidfd_send_signal(self._child.pidfd, number)
            elif not self._report.await_fact("over", 0.0):
                os.kill(self._child.pid, number)

    def _sweep(self) -> None:
        """Kill its descendants wherever they are, found by their environment or user."""
        family = [each for each in psutil.process_iter() if self._owns(each)]
        for each in family:
            with suppress(psutil.Error):
                each.kill()
        await_ends(family, PATIENCE_S)

    def _owns(self, process: psutil.Process) -> bool:
        if process.pid == os.getpid():
            return False
        with suppress(OSError, psutil.Error):
            if not self._users.isdisjoint(process.uids()):
                return True
            return process.environ().get(MARK) == self._mark
        return False

    def _read(self) -> None:
        with open(self._child.output, "rb") as output:  # noqa: PTH123
            while chunk := os.read(output.fileno(), 65536):
                room = KEPT_OUTPUT_BYTES - len(self._head)
                self._head += chunk[:room]
                self._tail += chunk[room:]
                if len(self._tail) > KEPT_OUTPUT_BYTES:
                    self._dropped += len(self._tail) - KEPT_OUTPUT_BYTES
                    del self._tail[:-KEPT_OUTPUT_BYTES]


class SubmissionProcess(StartedProcess):
    """A submission's process, below a supervisor that holds its whole family."""

    IS_SUPERVISED = True

    def __init__(
        self,
        command: ProcessCommand,
        server: ForkServer | None = None,
        budget: CpuBudget | None = None,
        beside: SubmissionProcess | None = None,
    ) -> None:
        """Start it; see `StartedProcess`.

        Args:
            budget: of the grading, which ends it and its descendants; None for none.
            beside: another of the same submission, with which it shares the limits.
        """
        self._guard: LimitsGuard | None = None
        self._excess = NOTHING
        super().__init__(command, server)
        self._guard = (beside and beside._guard) or LimitsGuard(budget=budget)
        self._guard.add(self._child.pid, self.kill, lambda: self.printed_bytes)

    def ends_for_excess(self) -> bool:
        """Measure its usage once more; return whether it is ended for too much, now or before."""
        return self._guard is not None and self._guard.measure_last()

    @property
    def excess(self) -> Message:
        """The remark for the result on what it and its descendants used too much of, or NOTHING."""
        return self._guard.remark if self._guard else self._excess

    @property
    def pid(self) -> int:
        """The process id of the command itself."""
        if not self._report.await_fact("pid", START_S) or "pid" not in self._report.facts:
            self.wait(0.0)
            raise GraderFailure(
                "the submission's process did not start: {output}", output=self.output()
            )
        return int(self._report.facts["pid"])

    def _await_end(self, timeout_s: float) -> int | None:
        if not self._report.await_fact("exit", timeout_s):
            return None
        # its supervisor ends without reporting it only if one of them was killed
        return int(self._report.facts.get("exit", -signal.SIGKILL))

    def kill(self) -> None:
        """End it and its family now, without waiting."""
        self._signal(signal.SIGTERM)

    def end(self, *, gently: bool = True) -> None:
        """Ask it to end as Ctrl-C would, then kill it, with its descendants."""
        if gently:
            self._signal_group(signal.SIGINT, signal.SIGTERM)
        if self._guard:
            self._guard.stop()
            # it knows us: as long as we know it, our descriptors wait for Python's garbage search
            self._excess, self._guard = self._guard.remark, None
        self.kill()
        self._report.await_fact("over", PATIENCE_S)
        if self._report.facts.get("over") != 0:  # the supervisor was stopped or killed
            self._signal(signal.SIGKILL)
            self._report.await_fact("over", PATIENCE_S)
            self._sweep()
        self._forget()
