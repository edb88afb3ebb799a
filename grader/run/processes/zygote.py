"""A fork server as the grader holds it: asked for processes, with a pidfd and a report each.

What it does itself is in `.forking`. A zygote has loaded what runs need; nothing depends on it:
where it cannot start, has died or refuses, `ZygoteLost` tells, and the process comes from a server
that has nothing loaded, forks once and executes the command (`cold`). Only where it dies over an
order, whose process may have begun, the run is void.
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
from collections.abc import Collection, Mapping, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any, NamedTuple

from grader.errors import GraderFailure
from grader.language.phrase import say
from grader.run.processes import ZYGOTE, forking
from grader.run.processes.refusal import Refusal

#: How long it may take to import everything, or to fork [s]; only a machine in distress does.
PATIENCE_S = 30.0
#: A submission with more files than this is not searched.
MOST_FILES = 10_000


class ZygoteLost(Exception):
    """A server gives no process; `refusal` says why."""

    def __init__(self, refusal: Refusal) -> None:
        super().__init__(refusal.why)
        self.refusal = refusal


class Child(NamedTuple):
    """What a server has forked.

    Attributes:
        pid: its process id, which is also that of its group.
        pidfd: of the same process; -1 where the system has none.
        report: the reading end of what becomes of it; see `.forking`.
        output: the reading end of what it prints on both outputs.
    """

    pid: int
    pidfd: int
    report: int
    output: int


def await_readable(descriptor: int, timeout_s: float) -> bool:
    """Whether there is something to read, or its other end is closed, within so long."""
    poll = select.poll()
    poll.register(descriptor, select.POLLIN)
    return bool(poll.poll(max(0, round(timeout_s * 1000))))


class Zygote:
    """A process that forks itself for others; any thread may ask."""

    def __init__(
        self,
        command: Sequence[str],
        env: Mapping[str, str],
        *more: str,
        executes: bool = False,
    ) -> None:
        """Start it; that it is ready is waited for where it is first asked.

        Args:
            command: a program that calls `.forking.serve` with what is added to it.
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
            words = (ZYGOTE, str(theirs.fileno()), *more)
            self._process = subprocess.Popen(
                [*self.command, *words],
                env={**self.env, forking.MARK: forking.NO_MARK},
                cwd="/",
                pass_fds=(theirs.fileno(),),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,  # a child's streams are made for a pipe, as they should be
                stderr=subprocess.STDOUT,
                start_new_session=True,  # Ctrl-C is not for it
            )

    @property
    def pid(self) -> int:
        """Its process id."""
        return self._process.pid

    def preloaded(self) -> frozenset[str]:
        """Top-level modules that a child has loaded, and a start from nothing would not have.

        Raises:
            ZygoteLost: it did not start.
        """
        with self._lock:
            return self._await_ready()

    def fork(
        self,
        command: Sequence[str],
        env: Mapping[str, str],
        cwd: Path | None = None,
        pass_fds: Sequence[int] = (),
        namespaces: Mapping[str, int] | None = None,
        confinement: Mapping[str, Any] | None = None,
        *,
        supervised: bool = False,
    ) -> Child:
        """A process as if `command` had been started.

        Args:
            namespaces: which it is in: kind -> descriptor, in the order in which they are entered.
            confinement: what its supervisor orders it; see `.sandbox.confinement`.
            supervised: whether a supervisor stands above it; see `.supervisor`.

        Raises:
            ZygoteLost: it gave none.
            GraderFailure: nobody knows whether it did.
            OSError: the grader has no descriptors left.
        """
        namespaces = namespaces or {}
        order = forking.Order(
            command=list(command),
            env=dict(env),
            server_env=self.env,
            cwd=str(cwd or Path.cwd()),
            fds=list(pass_fds),
            namespaces=list(namespaces),
            limits=forking.limits(),
            executes=self._executes,
            supervised=supervised,
            confinement=None if confinement is None else dict(confinement),
        )
        with ExitStack() as ours, ExitStack() as theirs:
            ordered = os.memfd_create("order")
            theirs.callback(os.close, ordered)
            os.write(ordered, json.dumps(order._asdict()).encode())
            os.lseek(ordered, 0, os.SEEK_SET)
            (output, printed), (report, told) = (_pipe(ours, theirs) for _ in range(2))
            with self._lock:
                self._await_ready()
                pid, pidfd = self._ask([ordered, printed, told, *namespaces.values(), *pass_fds])
                self.forks += 1
            ours.pop_all()
        return Child(pid, pidfd, report, output)

    def retire(self) -> None:
        """Let it end when its children have; those may go on. Who waits for it is answered."""
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
        assert self._process.stdout is not None
        self._process.stdout.close()

    def forget(self) -> None:
        """In a fork of the grader: it is another's."""
        self._lock = threading.Lock()  # a thread of the other's may have held it
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
            raise ZygoteLost(Refusal(0, "", "it is gone"))
        if self._preloaded is None:
            data, _ = self._hear()
            self._preloaded = frozenset(json.loads(data))
        return self._preloaded

    def _ask(self, fds: list[int]) -> tuple[int, int]:
        if len(fds) > forking.MOST_FDS:
            why = f"{len(fds)} descriptors are more than {forking.MOST_FDS}"
            raise ZygoteLost(Refusal(errno.E2BIG, "", why))
        try:
            socket.send_fds(self._socket, [b"order"], fds)
        except OSError as error:
            self._lose()
            raise ZygoteLost(Refusal.of(error)) from None
        except BaseException:
            self._lose()
            raise
        try:
            data, got = self._hear()
        except ZygoteLost as lost:
            raise GraderFailure(
                say("what a process was to be forked from has died: {lost}", lost=str(lost))
            ) from None
        answer = json.loads(data)
        if "lost" in answer:  # it has begun
            raise GraderFailure(say("a forked process was lost: {lost}", lost=str(answer["lost"])))
        if "refused" in answer:
            raise ZygoteLost(Refusal.from_line(str(answer["refused"])))
        return int(answer["pid"]), got[0] if got else -1

    def _hear(self) -> tuple[bytes, list[int]]:
        """An answer. Whatever comes between makes them lose step: the end."""
        try:
            answer, got, _, _ = socket.recv_fds(self._socket, forking.LIMIT_BYTES, 1)
        except OSError as error:
            self._lose()
            raise ZygoteLost(Refusal.of(error)) from None
        except BaseException:
            self._lose()
            raise
        if not answer:
            self._lose()
            raise ZygoteLost(Refusal(0, "", "it has died"))
        return answer, got

    def _lose(self) -> None:
        self._hang_up()
        self._process.kill()  # with a child that nobody has heard of

    def _hang_up(self) -> None:
        """Not while another thread waits for an answer, which would never come."""
        self.is_lost = True
        self._socket.close()


def cold(env: Mapping[str, str]) -> Zygote:
    """A server that has loaded nothing, whose children execute their command."""
    return Zygote([sys.executable, "-I", "-S", forking.__file__], env, executes=True)


def _pipe(ours: ExitStack, theirs: ExitStack) -> tuple[int, int]:
    """Both ends of a pipe: the reading one is ours."""
    reading, writing = os.pipe()
    ours.callback(os.close, reading)
    theirs.callback(os.close, writing)
    return reading, writing


def shadows(folder: Path, names: Collection[str]) -> bool:
    """Whether a submission has a module of its own of one of these names, or may have.

    What a zygote has loaded would win, where a start from nothing finds the submission's own. It
    may lie anywhere: submissions put folders of theirs on the import path.
    """
    seen = 0
    for place, folders, files in os.walk(folder):
        seen += len(files) + len(folders)
        if seen > MOST_FILES:
            return True
        # "numpy.py", "numpy.cpython-311-x86_64-linux-gnu.so", but not resource/, a mere marker
        if any(file.partition(".")[0] in names and _is_module(file) for file in files):
            return True
        if any(name in names and (Path(place) / name / "__init__.py").exists() for name in folders):
            return True
    return False


def _is_module(file: str) -> bool:
    return file.endswith((".py", ".pyc", ".so"))
