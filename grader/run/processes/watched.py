"""Start, watch and end processes so that none is left behind."""

from __future__ import annotations

import json
import os
import signal
import threading
import time
import uuid
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import FrameType
from typing import Any

import psutil

from grader import linux, system
from grader.errors import NotNow
from grader.language.phrase import say
from grader.run.processes.forking import MARK
from grader.run.processes.refusal import Refusal
from grader.run.processes.zygote import Child, Zygote, ZygoteLost, await_readable, cold

#: How much of a process's output is kept: this many bytes of its start and as many of its end.
KEEP_BYTES = 32_768
#: What asks the grader to end: Ctrl-C, `timeout` or `docker stop`, a closed terminal.
ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
#: What a process is told to end with, ever less gently.
INSISTING = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)


def adopt_orphans() -> None:
    """Become the parent of grandchildren whose parent ends, so that none of them outlives us.

    For a process that is the grader and nothing else; who calls us as a library is left as he is.
    """
    linux.control(linux.PR_SET_CHILD_SUBREAPER, 1)


_running: set[Watched] = set()
_is_ending = threading.Event()


def end_on_signals() -> None:
    """Let any signal of `ENDING` end all runs in good order, and then the main thread.

    It raises KeyboardInterrupt there. Runs in other threads see their processes die, and cannot
    start others; when they are through, nothing is left behind.
    """

    def end(number: int, frame: FrameType | None) -> None:
        for each in ENDING:
            signal.signal(each, signal.SIG_IGN)  # cleaning up is not to be cut short
        _is_ending.set()
        for process in list(_running):
            process.kill()
        raise KeyboardInterrupt

    for number in ENDING:
        # what the caller has had ignored (nohup) stays so
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, end)


def _all_processes(*others: int) -> list[int]:
    """The process ids of this user's processes, but for ourselves.

    Args:
        others: further users whose processes are ours.
    """
    me = os.getpid()
    users = (os.getuid(), *others)
    found = []
    for entry in system.PROC.iterdir():
        if entry.name.isdigit() and int(entry.name) != me:
            with suppress(OSError):
                if entry.stat().st_uid in users:
                    found.append(int(entry.name))
    return found


def await_ends(processes: Iterable[psutil.Process], timeout_s: float) -> list[psutil.Process]:
    """Wait for the ends of processes that are not our children; those that still run then.

    Whoever has adopted one may be slow to ask how it ended, as the first process of a container
    often is; and the first of a namespace sleeps until all others have been asked for. So one that
    has no memory any more has ended.
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
    """A process could not be confined or started, which was to be had before."""

    def __init__(self, refusal: Refusal) -> None:
        super().__init__(
            say("the submission's process could not be started: {why}", why=refusal.why)
        )
        self.refusal = refusal


class Watched:
    """A process in a session of its own whose output is read as it comes.

    However much it prints, only the start and the end are kept, and it never blocks on a full pipe.
    """

    #: it runs our own program, which leaves nothing behind when it comes to its end
    IS_OURS = True
    #: users whose processes are all its own
    _users: tuple[int, ...] = ()

    def __init__(
        self,
        command: Sequence[str],
        env: Mapping[str, str],
        cwd: Path | None = None,
        pass_fds: tuple[int, ...] = (),
        namespaces: Mapping[str, int] | None = None,
        zygote: Zygote | None = None,
        confinement: Mapping[str, Any] | None = None,
    ) -> None:
        """Start it.

        Args:
            namespaces: which it is in: kind -> descriptor.
            zygote: what it is forked from, if that can be; None: it starts from nothing.
            confinement: how it is confined; see `.sandbox.confinement`.
        """
        self._mark = uuid.uuid4().hex
        self._told: dict[str, Any] = {}
        self._lines, self._is_silent = b"", False
        #: the server that was started for this process alone
        self._cold: Zygote | None = None
        marked = {**env, MARK: self._mark}
        words = (command, marked, cwd, pass_fds, namespaces, confinement)
        child: Child | None = None
        if zygote is not None:
            with suppress(ZygoteLost):
                child = zygote.fork(*words, supervised=not self.IS_OURS)
        if child is None:
            self._cold = cold(env)
            try:
                child = self._cold.fork(*words, supervised=not self.IS_OURS)
            except ZygoteLost as lost:
                raise NotConfined(lost.refusal) from None
            finally:
                self._cold.retire()
        self._child = child
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
        """The process id."""
        return self._child.pid

    def poll(self) -> int | None:
        """The exit code, negative for a signal, or None while it runs."""
        return self.wait(0.0)

    def wait(self, timeout_s: float) -> int | None:
        """Wait for its end; None if it still runs then.

        Raises:
            NotConfined: it could not be confined, or started.
        """
        code = self._await_end(timeout_s)
        if code is not None and "refused" in self._told:
            raise NotConfined(Refusal.from_line(str(self._told["refused"])))
        return code

    def _await_end(self, timeout_s: float) -> int | None:
        if not self._hear("exit", timeout_s):
            return None
        # a supervisor ends without a word on its command only if somebody has killed one of them
        default = self._told.get("over", -signal.SIGKILL) if self.IS_OURS else -signal.SIGKILL
        return int(self._told.get("exit", default))

    def _hear(self, what: str, timeout_s: float) -> bool:
        """Whether its report has told that, or come to its end."""
        deadline = time.monotonic() + timeout_s
        report = self._child.report
        while not (report < 0 or self._is_silent or self._told.keys() & {what, "over"}):
            if not await_readable(report, max(0.0, deadline - time.monotonic())):
                return False
            news = os.read(report, 4096)
            *lines, self._lines = (self._lines + news).split(b"\n")
            for line in lines:
                self._told.update(json.loads(line))
            self._is_silent = not news
        return True

    @property
    def was_lost(self) -> bool:
        """Whether it ended because a process of ours did, which is no doing of its own."""
        return self._is_silent and "over" not in self._told and self._cold is None

    def ends_for_excess(self) -> bool:
        """A last look: whether it is ended for taking too much, now or before."""
        return False

    @property
    def excess(self) -> str:
        """Of what it took too much, for the result; '' if of nothing, or if nobody has looked."""
        return ""

    @property
    def printed_bytes(self) -> int:
        """How much it has printed."""
        return len(self._head) + self._dropped + len(self._tail)

    def output(self) -> str:
        """What it has printed: all of it, or its start and end with a note between."""
        self._reader.join(1.0)  # ends with the process, unless a grandchild keeps the pipe
        middle = f"\n[... {self._dropped} bytes left out ...]\n" if self._dropped else ""
        return (
            self._head.decode("utf-8", "replace") + middle + self._tail.decode("utf-8", "replace")
        )

    def kill(self) -> None:
        """End it now, and do not wait."""
        self._signal(signal.SIGKILL)

    def end(self, patience_s: float = 2.0, *, gently: bool = True) -> None:
        """Ask it to end as Ctrl-C would, then insist; its descendants go with it."""
        is_through = self._await_end(0.0) == 0
        for sent in INSISTING if gently else INSISTING[-1:]:
            if self._await_end(0.0) is None:
                with suppress(ProcessLookupError):
                    os.killpg(self._child.pid, sent)
                self._await_end(patience_s)
        if not is_through:
            self._sweep(patience_s)
        self._forget()

    def _forget(self) -> None:
        """It has ended: the end of the grader needs not see to it, and what it held is free."""
        _running.discard(self)
        for descriptor in {self._child.pidfd, self._child.report} - {-1}:
            os.close(descriptor)
        self._child = self._child._replace(pidfd=-1, report=-1)
        if self._cold is not None:
            self._cold.close()

    def _signal(self, number: signal.Signals) -> None:
        """A signal to it, or to its supervisor."""
        with suppress(OSError):  # it has ended
            if self._child.pidfd >= 0:
                signal.pidfd_send_signal(self._child.pidfd, number)
            elif self._child.report >= 0 and not self._hear("over", 0.0):
                os.kill(self._child.pid, number)

    def _sweep(self, patience_s: float) -> None:
        """End what it has started, wherever that has gone: its environment tells."""
        family = []
        for pid in _all_processes(*self._users):
            with suppress(psutil.Error):
                process = psutil.Process(pid)  # remembers when it started: a number may be reused
                if self._owns(pid):
                    family.append(process)
                    process.kill()
        await_ends(family, patience_s)

    def _owns(self, pid: int) -> bool:
        with suppress(OSError, psutil.Error):
            if self._users and Path(f"/proc/{pid}").stat().st_uid in self._users:
                return True
            return f"{MARK}={self._mark}".encode() in Path(f"/proc/{pid}/environ").read_bytes()
        return False

    def _read(self) -> None:
        with open(self._child.output, "rb") as output:  # noqa: PTH123
            while chunk := os.read(output.fileno(), 65536):
                self._keep(chunk)

    def _keep(self, chunk: bytes) -> None:
        room = KEEP_BYTES - len(self._head)
        self._head += chunk[:room]
        self._tail += chunk[room:]
        if len(self._tail) > KEEP_BYTES:
            self._dropped += len(self._tail) - KEEP_BYTES
            del self._tail[:-KEEP_BYTES]
