"""The grader's side of a fork server: asks it for processes, with a pidfd and a report each.

The server itself is `.fork_server_main`. A server that has loaded what runs need is a short cut,
and nothing depends on it: where it cannot start, has died or refuses, `ServerLost` is raised, and
the process comes from a server that has loaded nothing, forks once and executes the command
(`cold_server`). Only where it dies during an order, whose process may run by then, the run is void.
"""

from __future__ import annotations

import errno
import json
import os
import select
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any, NamedTuple

from grader.errors import GraderFailure
from grader.run.processes import FORK_SERVER, fork_server_main
from grader.run.processes.fork_server_main import ForkOrder, ProcessCommand
from grader.run.processes.refusal import Refusal
from grader.system import linux

#: How long it may take to import everything, or to fork [s]; only an overloaded machine does.
PATIENCE_S = 30.0


class ServerLost(Exception):
    """A server gives no process, for the reason in `refusal`."""

    def __init__(self, refusal: Refusal) -> None:
        super().__init__(refusal.why)
        self.refusal = refusal


class ProcessReport:
    """The report on a process by its server and its supervisor; see `.fork_server_main`.

    Attributes:
        facts: what was reported so far.
        is_complete: whether nothing more comes.
    """

    def __init__(self, descriptor: int) -> None:
        self.facts: dict[str, Any] = {}
        self.is_complete = False
        self._descriptor, self._rest = descriptor, b""
        self._poll = select.poll()
        self._poll.register(descriptor, select.POLLIN)

    def await_fact(self, name: str, timeout_s: float) -> bool:
        """Wait for a fact of this name; return False if neither it nor the end came in time."""
        deadline = time.monotonic() + timeout_s
        while not (self._descriptor < 0 or self.is_complete or self.facts.keys() & {name, "over"}):
            if not self._poll.poll(max(0, round(1000 * (deadline - time.monotonic())))):
                return False
            news = os.read(self._descriptor, 4096)
            *lines, self._rest = (self._rest + news).split(b"\n")
            for line in lines:
                self.facts.update(json.loads(line))
            self.is_complete = not news
        return True

    def close(self) -> None:
        if self._descriptor >= 0:
            os.close(self._descriptor)
        self._descriptor = -1


class Child(NamedTuple):
    """A forked process.

    Attributes:
        pid: its process id, which is also that of its group.
        pidfd: a descriptor of it; -1 where the system has none.
        report: the report on it.
        output: the reading end of the pipe of both its outputs.
    """

    pid: int
    pidfd: int
    report: ProcessReport
    output: int


class ForkServer:
    """A process that forks itself for others; any thread may ask it."""

    def __init__(
        self,
        command: Sequence[str],
        env: Mapping[str, str],
        *more: str,
        executes: bool = False,
    ) -> None:
        """Start it; the first request waits until it is ready.

        Args:
            command: a program that calls `.fork_server_main.serve` with the added arguments.
            env: its environment variables; its children get their own.
            more: arguments that follow those of `serve`.
            executes: whether its children execute their command.
        """
        self.command, self.env, self._executes = tuple(command), dict(env), executes
        self.is_lost = False
        #: how many processes it has given
        self.forks = 0
        self._lock = threading.Lock()
        self._preloaded: frozenset[str] | None = None
        self._socket, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._socket.settimeout(PATIENCE_S)
        with theirs:
            words = (FORK_SERVER, str(theirs.fileno()), *more)
            self._process = subprocess.Popen(
                [*self.command, *words],
                env={**self.env, fork_server_main.MARK: fork_server_main.NO_MARK},
                cwd="/",
                pass_fds=(theirs.fileno(),),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,  # a child's streams are made for a pipe, as they should be
                stderr=subprocess.STDOUT,
                start_new_session=True,  # Ctrl-C is not for it
            )

    @property
    def pid(self) -> int:
        return self._process.pid

    def preloaded(self) -> frozenset[str]:
        """Return the top-level modules that a child has loaded, but a cold start would not have.

        Raises:
            ServerLost: it did not start.
        """
        with self._lock:
            return self._await_ready()

    def fork(self, command: ProcessCommand, *, supervised: bool = False) -> Child:
        """Fork a process, as if this command had been started.

        Args:
            supervised: whether a supervisor stands above it; see `.supervisor`.

        Raises:
            ServerLost: the server made none.
            GraderFailure: it is unknown whether it did.
            OSError: the grader has no descriptors left.
        """
        command = command._replace(env=dict(command.env), cwd=str(command.cwd or Path.cwd()))
        limits = linux.resource_limits()
        order = ForkOrder(command, self.env, limits, self._executes, supervised)
        with ExitStack() as ours, ExitStack() as theirs:
            ordered = os.memfd_create("order")
            theirs.callback(os.close, ordered)
            os.write(ordered, json.dumps(order).encode())
            os.lseek(ordered, 0, os.SEEK_SET)
            (output, printed), (report, reported) = (_pipe(ours, theirs) for _ in range(2))
            with self._lock:
                self._await_ready()
                fds = (printed, reported, *command.namespaces.values(), *command.fds)
                pid, pidfd = self._ask(command.needs, [ordered, *fds])
                self.forks += 1
            ours.pop_all()
        return Child(pid, pidfd, ProcessReport(report), output)

    def retire(self) -> None:
        """Let it end after its children, which go on; pending requests are answered."""
        with self._lock:
            self.is_lost = True
            with suppress(OSError):  # it has died, or is lost already
                self._socket.shutdown(socket.SHUT_WR)

    def close(self) -> None:
        """End it, and what it has left; wait for that."""
        self._process.kill()  # which also ends an exchange
        with self._lock:
            self._hang_up()
        self._process.wait()
        if self._process.stdout is not None:
            self._process.stdout.close()

    def forget(self) -> None:
        """Drop it in a fork of the grader: it belongs to the parent."""
        self._lock = threading.Lock()  # a thread of the parent's may have held it
        self._hang_up()
        self._process.returncode = 0

    def has_ended(self) -> bool:
        """Whether nothing is left of it."""
        if self._process.poll() is None:
            return False
        self.close()
        return True

    def _await_ready(self) -> frozenset[str]:
        if self.is_lost:
            raise ServerLost(Refusal(0, "", "it is gone"))
        if self._preloaded is None:
            data, _ = self._receive()
            self._preloaded = frozenset(json.loads(data))
        return self._preloaded

    def _ask(self, needs: str, fds: list[int]) -> tuple[int, int]:
        """Have the server fork; the process id of the child, and a pidfd of it or -1."""
        if len(fds) > fork_server_main.MOST_FDS:
            why = f"{len(fds)} descriptors are more than {fork_server_main.MOST_FDS}"
            raise ServerLost(Refusal(errno.E2BIG, "", why))
        with self._exchanging():
            socket.send_fds(self._socket, [json.dumps(needs).encode()], fds)
        try:
            data, got = self._receive()
        except ServerLost as lost:
            raise GraderFailure(
                "what a process was to be forked from has died: {lost}", lost=str(lost)
            ) from None
        answer = json.loads(data)
        if "lost" in answer:  # it has begun
            raise GraderFailure("a forked process was lost: {lost}", lost=str(answer["lost"]))
        if "refused" in answer:
            raise ServerLost(Refusal.from_line(str(answer["refused"])))
        return int(answer["pid"]), got[0] if got else -1

    def _receive(self) -> tuple[bytes, list[int]]:
        """Receive an answer, and the descriptors that come with it."""
        with self._exchanging():
            answer, got, _, _ = socket.recv_fds(self._socket, fork_server_main.LIMIT_BYTES, 1)
            if not answer:
                raise ServerLost(Refusal(0, "", "it has died"))
        return answer, got

    @contextmanager
    def _exchanging(self) -> Iterator[None]:
        """End the server if an exchange fails: its answers would no longer match the requests."""
        try:
            yield
        except BaseException as error:
            self._hang_up()
            self._process.kill()  # with a child that may be unknown here
            if isinstance(error, OSError):
                raise ServerLost(Refusal.of(error)) from None
            raise

    def _hang_up(self) -> None:
        """Close the socket; not while another thread waits for an answer: it would never come."""
        self.is_lost = True
        self._socket.close()


def cold_server(env: Mapping[str, str]) -> ForkServer:
    """Start a server that has loaded nothing, whose children execute their command."""
    return ForkServer([sys.executable, "-I", "-S", fork_server_main.__file__], env, executes=True)


def _pipe(ours: ExitStack, theirs: ExitStack) -> tuple[int, int]:
    """Make a pipe; the reading end is ours."""
    reading, writing = os.pipe()
    ours.callback(os.close, reading)
    theirs.callback(os.close, writing)
    return reading, writing
