"""A submission's process with all its descendants: held as well as this system can."""

from __future__ import annotations

import json
import os
import select
import signal
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from grader.errors import GraderFailure, NotNow
from grader.language.phrase import say
from grader.run.budget import Budget
from grader.run.processes import supervisor
from grader.run.processes.appetite import Appetite
from grader.run.processes.refusal import Refusal
from grader.run.processes.sandbox.confinement import OWN
from grader.run.processes.watched import Watched
from grader.run.processes.zygote import Warm

#: How long a process may take to come up [s]; only a machine in distress takes so long.
START_S = 30.0
#: Stands for an exit code: the command was never started.
NOT_STARTED = 1 << 16
SUPERVISOR = (sys.executable, "-I", "-S", supervisor.__file__, "run")


class NotConfined(NotNow):
    """A submission's process could not be confined or started, which was to be had before."""

    def __init__(self, refusal: Refusal) -> None:
        super().__init__(
            say("the submission's process could not be started: {why}", why=refusal.why)
        )
        self.refusal = refusal


class Student(Watched):
    """A submission's process, below a supervisor that holds its whole family."""

    IS_OURS = False

    def __init__(
        self,
        command: Sequence[str],
        env: Mapping[str, str],
        cwd: Path | None = None,
        pass_fds: tuple[int, ...] = (),
        entry: Sequence[str] = (),
        warm: Warm | None = None,
        confinement: Mapping[str, Any] | None = None,
        budget: Budget | None = None,
    ) -> None:
        """Start it; see `Watched`.

        Args:
            entry: stands before the supervisor's own command; see `.isolation`.
            confinement: how it is confined; see `.sandbox.confinement`.
            budget: what it and its descendants spend of, and that ends them; None for none.
        """
        self._report, theirs = os.pipe()
        self._told = b""
        self._is_silent = False
        self._appetite: Appetite | None = None
        self._excess = ""
        if confinement and confinement.get("user") == OWN:
            self._users = (confinement["uid"],)
        with tempfile.TemporaryFile() as order:
            order.write(json.dumps(confinement).encode())
            order.flush()
            fds = (theirs, order.fileno())
            supervised = [*entry, *SUPERVISOR, str(os.getpid()), *map(str, fds)]
            try:
                super().__init__(command, env, cwd, pass_fds, supervised, warm, *fds, confinement)
            except BaseException:
                self._close()
                raise
            finally:
                os.close(theirs)
        self._appetite = Appetite(
            *(self._process.pid, self.kill), budget=budget, printed_bytes=lambda: self.printed_bytes
        )

    def ends_for_excess(self) -> bool:
        """A last look: whether it is ended for taking too much, now or before."""
        return self._appetite is not None and self._appetite.look_last()

    @property
    def excess(self) -> str:
        """Of what it and its descendants took too much, for the result; '' if of nothing."""
        return self._appetite.remark if self._appetite else self._excess

    @property
    def pid(self) -> int:
        """The process id of the command itself.

        Raises:
            GraderFailure: it could not be started.
        """
        if not self._hear(1, START_S):
            raise GraderFailure(
                say("the submission's process did not start: {output}", output=self.output())
            )
        return int(self._told.split()[0])

    def poll(self) -> int | None:
        """The exit code of the command itself, negative for a signal, or None while it runs."""
        return self.wait(0.0)

    def wait(self, timeout_s: float) -> int | None:
        """Wait for the end of the command itself; None if it still runs then.

        Raises:
            NotConfined: it could not be confined, or started.
        """
        code = self._await_end(timeout_s)
        if code == NOT_STARTED:
            line = self._words().removeprefix(supervisor.REFUSED).strip()
            raise NotConfined(Refusal.from_line(line))
        return code

    def _await_end(self, timeout_s: float) -> int | None:
        if self._hear(2, timeout_s):
            word = self._words()
            return NOT_STARTED if word.startswith(supervisor.REFUSED) else int(word)
        # a supervisor ends without a word only if somebody has killed it
        return -signal.SIGKILL if self._is_silent else None

    def _words(self) -> str:
        """How it ended, or why it was refused."""
        return self._told.splitlines()[1].decode("utf-8", "replace")

    def kill(self) -> None:
        """End it and its family now, and do not wait."""
        if self._process.poll() is None:
            self._process.terminate()

    def end(self, patience_s: float = 2.0, *, gently: bool = True) -> None:
        """Ask it to end as Ctrl-C would, then insist; its descendants go with it."""
        for sent in (signal.SIGINT, signal.SIGTERM) if gently else ():
            if self._await_end(0.0) is None:
                with suppress(ProcessLookupError):
                    if sent == signal.SIGINT:
                        os.killpg(self.pid, sent)  # as a terminal does
                    else:
                        os.kill(self.pid, sent)
                self._await_end(patience_s)
        if self._appetite:
            self._appetite.stop()
            # it knows us: as long as we know it, our descriptors wait for Python's garbage search
            self._excess, self._appetite = self._appetite.remark, None
        self.kill()
        if super().wait(patience_s) != 0:  # somebody has stopped or killed the supervisor
            self._process.kill()
            super().wait(patience_s)
            self._sweep(patience_s)
        self.forget()
        self._close()

    def _hear(self, lines: int, timeout_s: float) -> bool:
        """Whether the supervisor has told so many lines."""
        deadline = time.monotonic() + timeout_s
        while self._told.count(b"\n") < lines and not self._is_silent:
            left = max(0.0, deadline - time.monotonic())
            if not select.select([self._report], [], [], left)[0]:
                break
            news = os.read(self._report, 4096)
            self._told += news
            self._is_silent = not news
        return self._told.count(b"\n") >= lines

    def _close(self) -> None:
        if self._report >= 0:
            os.close(self._report)
        self._report, self._is_silent = -1, True
