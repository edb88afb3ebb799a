"""The simulator's process as the grader sees it: started, talked with, ended."""

from __future__ import annotations

import json
import selectors
import socket
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from grader.errors import GraderFailure
from grader.language.phrase import say
from grader.run.audience import NOBODY, Seat
from grader.run.environment import simulator_environment
from grader.run.plan import Plan
from grader.run.processes.line import Line
from grader.run.processes.watched import Watched
from grader.run.processes.zygote import Zygote
from grader.run.stage import Stage

#: How long the simulator may take to come up, and to save the recording [s].
SIMULATOR_PATIENCE_S = 60.0

Message = dict[str, Any]


class Simulator:
    """The simulator's process, and the line to it."""

    def __init__(self, process: Watched, ours: socket.socket) -> None:
        #: whether a submission has something to do with it
        self.is_driven = False
        self._process = process
        self._socket = ours
        self._text = b""

    @property
    def pid(self) -> int:
        """The process id."""
        return self._process.pid

    def expect(self, what: str) -> None:
        """Wait for a message.

        Raises:
            GraderFailure: another one comes, none comes in time, or the simulator dies.
        """
        deadline = time.monotonic() + SIMULATOR_PATIENCE_S
        while (message := self.next(0.2)) is None:
            if time.monotonic() > deadline:
                raise self.failure(
                    say(
                        "did not say {what!r} in {seconds:.0f} s",
                        what=what,
                        seconds=SIMULATOR_PATIENCE_S,
                    )
                )
        if message["say"] != what:
            raise self.failure(
                say("said {message!r} where {what!r} was expected", message=message, what=what)
            )

    def say(self, what: str) -> None:
        """Tell it something.

        Raises:
            GraderFailure: it does not listen.
        """
        try:
            self._socket.sendall(json.dumps({"say": what}).encode() + b"\n")
        except OSError:
            raise self.failure("stopped listening") from None

    def next(self, patience_s: float) -> Message | None:
        """The next message, or None if there is none yet.

        Raises:
            GraderFailure: it has died.
        """
        if b"\n" not in self._text:
            with selectors.DefaultSelector() as selector:
                selector.register(self._socket, selectors.EVENT_READ)
                if not selector.select(patience_s):
                    return None
            try:
                chunk = self._socket.recv(65536)
            except ConnectionError:
                chunk = b""
            if not chunk:
                raise self.failure("died")
            self._text += chunk
            return None
        line, _, self._text = self._text.partition(b"\n")
        message: Message = json.loads(line)
        return message

    def failure(self, what: str) -> GraderFailure:
        """The exception for a simulator that did not do its work."""
        code = self._process.wait(2.0)
        state = say("it still runs") if code is None else say("its exit code is {code}", code=code)
        last = self._process.output().strip() or say("(it printed nothing)")
        return GraderFailure(
            say(
                "the simulator {what}; {state}. Its last words:\n{last}",
                what=what,
                state=state,
                last=last[-2000:],
            )
        )


@contextmanager
def start_simulator(
    module: str,
    stage: Stage,
    plan: Plan,
    link: socket.socket | None = None,
    *more: str,
    zygote: Zygote | None = None,
    seat: Seat = NOBODY,
) -> Iterator[Simulator]:
    """Start `module` as the simulator's process.

    Args:
        link: inherited as well; its number follows the first three arguments.
        more: further arguments.
        seat: how it is told that somebody looks on; the last argument.
        zygote: what it is forked from, if that can be.
    """
    with Line() as line:
        links = [link.fileno()] if link else []
        words = [line.word, stage.recording_path, plan.to_json(), *map(str, links), *more]
        command = [sys.executable, "-m", module, *words, seat.word]
        env = simulator_environment(stage.env)
        folder = stage.simulator_folder
        fds = (*line.fds, *links, stage.recording, folder, *seat.fds)
        here = Path(f"/proc/self/fd/{folder}")
        process = Watched(command, env, here, fds, stage.namespaces, zygote)
        try:
            yield Simulator(process, line.connect())
        finally:
            process.end()
