"""A submission's process with all its descendants: held as well as this system can."""

from __future__ import annotations

import os
import signal
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from grader.errors import GraderFailure
from grader.language.phrase import say
from grader.run.budget import Budget
from grader.run.processes.appetite import Appetite
from grader.run.processes.sandbox.confinement import OWN
from grader.run.processes.watched import Watched
from grader.run.processes.zygote import Zygote

#: How long a process may take to come up [s]; only a machine in distress takes so long.
START_S = 30.0


class Student(Watched):
    """A submission's process, below a supervisor that holds its whole family."""

    IS_OURS = False

    def __init__(
        self,
        command: Sequence[str],
        env: Mapping[str, str],
        cwd: Path | None = None,
        pass_fds: tuple[int, ...] = (),
        namespaces: Mapping[str, int] | None = None,
        zygote: Zygote | None = None,
        confinement: Mapping[str, Any] | None = None,
        budget: Budget | None = None,
    ) -> None:
        """Start it; see `Watched`.

        Args:
            budget: what it and its descendants spend of, and that ends them; None for none.
        """
        self._appetite: Appetite | None = None
        self._excess = ""
        if confinement and confinement.get("user") == OWN:
            self._users = (confinement["uid"],)
        super().__init__(command, env, cwd, pass_fds, namespaces, zygote, confinement)
        self._appetite = Appetite(
            *(self._child.pid, self.kill), budget=budget, printed_bytes=lambda: self.printed_bytes
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
            GraderFailure, NotConfined: it could not be started.
        """
        if not self._hear("pid", START_S) or "pid" not in self._told:
            self.wait(0.0)
            raise GraderFailure(
                say("the submission's process did not start: {output}", output=self.output())
            )
        return int(self._told["pid"])

    def kill(self) -> None:
        """End it and its family now, and do not wait."""
        self._signal(signal.SIGTERM)

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
        self._hear("over", patience_s)
        if self._told.get("over") != 0:  # somebody has stopped or killed the supervisor
            self._signal(signal.SIGKILL)
            self._hear("over", patience_s)
            self._sweep(patience_s)
        self._forget()
