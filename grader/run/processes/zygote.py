"""A zygote as the grader holds it: asked for processes that need not start from nothing.

What it does itself is in `.forking`. Nothing depends on it: where it cannot start, has died or
refuses, `ZygoteLost` tells, and the process is started from nothing. Only where it dies over an
order, whose process may have begun, the run is void.
"""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import threading
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from grader.errors import GraderFailure
from grader.language.phrase import say
from grader.run.processes import ZYGOTE, forking
from grader.run.processes.process import await_readable

#: How long it may take to import everything, or to fork [s]; only a machine in distress does.
PATIENCE_S = 30.0
#: A submission with more files than this is not searched.
MOST_FILES = 10_000


class ZygoteLost(Exception):
    """A zygote gives no process; the text says why."""


class Forked:
    """A zygote's child; a `grader.run.processes.process.Process`."""

    def __init__(self, pid: int, pidfd: int, ending: int, stdout: BinaryIO) -> None:
        self.pid = pid
        self.stdout = stdout
        self._pidfd = pidfd
        self._ending = ending
        self._code: int | None = None
        self.was_lost = False
        # a handler of signals, in the middle of a wait, may ask as well
        self._lock = threading.RLock()

    def poll(self) -> int | None:
        """The exit code, negative for a signal, or None while it runs."""
        return self.wait(0.0)

    def wait(self, timeout_s: float) -> int | None:
        """Wait for its end; None if it still runs then."""
        if self._code is None and await_readable(self._ending, timeout_s):
            with self._lock:
                told = os.read(self._ending, 16) if self._code is None else b""
                if self._code is None:
                    # a zygote that has died takes its children along, and tells nothing
                    self._code = int(told) if told else -signal.SIGKILL
                    self.was_lost = not told
        return self._code

    def kill(self) -> None:
        """Send it SIGKILL, if it still runs."""
        self._send(signal.SIGKILL)

    def terminate(self) -> None:
        """Send it SIGTERM, if it still runs."""
        self._send(signal.SIGTERM)

    def _send(self, number: signal.Signals) -> None:
        with suppress(ProcessLookupError):
            signal.pidfd_send_signal(self._pidfd, number)

    def __del__(self) -> None:
        for fd in (self._pidfd, self._ending):
            with suppress(OSError):
                os.close(fd)


class Zygote:
    """A process that forks itself for others; any thread may ask."""

    def __init__(self, command: Sequence[str], env: Mapping[str, str], *more: str) -> None:
        """Start it; that it is ready is waited for where it is first asked.

        Args:
            command: a program that calls `.forking.serve` with what is added to it.
            env: its environment variables; its children get their own.
            more: arguments that follow those of `serve`.
        """
        self.command, self.env = tuple(command), dict(env)
        self.is_lost = False
        #: how many processes it has given
        self.forks = 0
        self._lock = threading.Lock()
        self._preloaded: frozenset[str] | None = None
        self._socket, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._socket.settimeout(PATIENCE_S)
        with theirs:
            words = (ZYGOTE, str(theirs.fileno()), str(os.getpid()), *more)
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
        cwd: Path | None,
        pass_fds: Sequence[int],
        namespaces: Mapping[str, int],
        report: int = -1,
        confinement: Mapping[str, Any] | None = None,
    ) -> Forked:
        """A process as if `command` had been started, in these namespaces.

        Args:
            namespaces: kind -> descriptor, in the order in which they are entered.
            report: of a supervisor, which then stands between; see `.supervisor`.
            confinement: what that orders the process; see `.sandbox.confinement`.

        Raises:
            ZygoteLost: it gave none.
            GraderFailure: nobody knows whether it did.
        """
        order = forking.Order(
            command=command,
            env=env,
            zygote_env=self.env,
            cwd=str(cwd or Path.cwd()),
            fds=pass_fds,
            namespaces=list(namespaces),
            limits=forking.limits(),
            supervised=report >= 0,
            confinement=None if confinement is None else dict(confinement),
        )
        ours, theirs = os.pipe()
        reports = [report] if report >= 0 else []
        try:
            with self._lock:
                self._await_ready()
                fds = [theirs, *reports, *namespaces.values(), *pass_fds]
                pid, pidfd, ending = self._ask(order.to_bytes(), fds)
                self.forks += 1
        except BaseException:
            os.close(ours)
            raise
        finally:
            os.close(theirs)
        return Forked(pid, pidfd, ending, os.fdopen(ours, "rb"))

    def retire(self) -> None:
        """Let it end when its children have; those may go on. Who waits for it is answered."""
        with self._lock:
            self._hang_up()

    def close(self) -> None:
        """End it, and what it has left; wait for that."""
        self._process.kill()  # which also ends an exchange
        self.retire()
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
        assert self._process.stdout is not None
        self._process.stdout.close()
        return True

    def _await_ready(self) -> frozenset[str]:
        if self.is_lost:
            raise ZygoteLost("it is gone")
        if self._preloaded is None:
            data, _ = self._hear()
            self._preloaded = frozenset(json.loads(data))
        return self._preloaded

    def _ask(self, order: bytes, fds: list[int]) -> tuple[int, int, int]:
        if len(order) > forking.LIMIT_BYTES or len(fds) > forking.MOST_FDS:
            raise ZygoteLost("the order is too long")
        try:
            socket.send_fds(self._socket, [order], fds)
        except OSError as error:
            self._lose()
            raise ZygoteLost(repr(error)) from None
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
            raise ZygoteLost(str(answer["refused"]))
        pidfd, ending = got
        return int(answer["pid"]), pidfd, ending

    def _hear(self) -> tuple[bytes, list[int]]:
        """An answer. Whatever comes between makes them lose step: the end."""
        try:
            answer, got, _, _ = socket.recv_fds(self._socket, forking.LIMIT_BYTES, 2)
        except OSError as error:
            self._lose()
            raise ZygoteLost(repr(error)) from None
        except BaseException:
            self._lose()
            raise
        if not answer:
            self._lose()
            raise ZygoteLost("it has died")
        return answer, got

    def _lose(self) -> None:
        self._hang_up()
        self._process.kill()  # with a child that nobody has heard of

    def _hang_up(self) -> None:
        """Not while another thread waits for an answer, which would never come."""
        self.is_lost = True
        self._socket.close()


@dataclass(frozen=True)
class Warm:
    """A zygote, and the namespaces that its next child is to enter: kind -> descriptor."""

    zygote: Zygote
    namespaces: Mapping[str, int]


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
