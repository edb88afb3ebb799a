"""The simulator's process from the grader's side: start it, exchange messages, end it.

During a run it also reports to an audience, over a separate socket. Nothing goes the other way
there, so the recording does not depend on the audience. The submission's process has neither end.
"""

from __future__ import annotations

import json
import socket
import sys
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, Final, Protocol

from grader.errors import GraderFailure, SceneFailure
from grader.recording.recording import Clock
from grader.run.environment import simulator_environment
from grader.run.handover import Plan
from grader.run.limits import SIMULATOR_S
from grader.run.processes.fork_server import ForkServer
from grader.run.processes.fork_server_main import ProcessCommand
from grader.run.processes.started_process import StartedProcess
from grader.run.run_context import RunContext
from grader.run.simulator.process import send_message
from grader.text.message import Message, msg

SimulatorMessage = dict[str, Any]
#: News of this time is passed on together [s]: 31 times a second.
TOGETHER_S: Final = 0.032
#: The most that is read at once, and the longest line [bytes].
CHUNK_BYTES, LONGEST_BYTES = 1 << 20, 64_000_000


class Simulator:
    """The simulator's process, and the socket over which the grader talks with it."""

    def __init__(self, process: StartedProcess, ours: socket.socket) -> None:
        #: whether a submission has sent it something
        self.is_driven = False
        self._process = process
        self._socket = ours
        self._text = b""

    @property
    def pid(self) -> int:
        return self._process.pid

    def expect(self, what: str) -> None:
        """Wait for a message."""
        deadline = time.monotonic() + SIMULATOR_S
        while (message := self.next(0.2)) is None:
            if time.monotonic() > deadline:
                raise self.failure(
                    msg("did not say {what!r} in {seconds:.0f} s", what=what, seconds=SIMULATOR_S)
                )
        assert message["say"] == what

    def send(self, what: str) -> None:
        """Send it a message."""
        with suppress(OSError):  # it has died; `next` says so, or why
            send_message(self._socket, what)

    def next(self, patience_s: float) -> SimulatorMessage | None:
        """The next message, or None if there is none yet.

        Raises:
            SceneFailure: it says so.
            GraderFailure: it has died.
        """
        if b"\n" not in self._text:
            self._socket.settimeout(patience_s)
            try:
                chunk = self._socket.recv(65536)
            except TimeoutError:
                return None
            except ConnectionError:
                chunk = b""
            if not chunk:
                raise self.failure(msg("died"))
            self._text += chunk
            return None
        line, _, self._text = self._text.partition(b"\n")
        message: SimulatorMessage = json.loads(line)
        if message["say"] == "failed":
            raise SceneFailure(Message.parse(message["reason"]))
        return message

    def failure(self, what: Message) -> GraderFailure:
        """Return the exception for a simulator that did not do its work."""
        code = self._process.wait(2.0)
        state = msg("it still runs") if code is None else msg("its exit code is {code}", code=code)
        last = self._process.output().strip()[-2000:]
        return GraderFailure(
            "{how}. Its last words:\n{last}",
            how=msg("the simulator {what}; {state}", what=what, state=state),
            last=last or msg("(it printed nothing)"),
        )


# The audience ---------------------------------------------------------------------------------


class Audience(Protocol):
    """Receives runs live, one after the other."""

    @property
    def speed(self) -> float | None:
        """The speed of virtual time, as a multiple of real time; None: as fast as it can."""

    def begins(self, plan: Plan, time: Clock) -> None:
        """Called when a run begins; again with the same plan where the first run was in vain."""

    def hear(self, news: Sequence[Mapping[str, Any]]) -> None:
        """Receive the news of the run, in order; called in a separate thread."""

    def ends(self, is_whole: bool) -> None:
        """Called when nothing more comes of this run; `is_whole`: nothing was left out."""


#: What the simulator's process gets of an audience: an argument, and a descriptor.
LiveFeed = tuple[str, tuple[int, ...]]


@contextmanager
def live_feed(audience: Audience | None, plan: Plan, time: Clock) -> Iterator[LiveFeed]:
    """Open the feed of a run; leaving the context waits until the audience has all of it."""
    if audience is None:
        yield "", ()
        return
    ours, theirs = socket.socketpair()
    ours.shutdown(socket.SHUT_WR)
    audience.begins(plan, time)
    listener = threading.Thread(target=_listen, args=(ours, audience), name="audience", daemon=True)
    listener.start()
    try:
        with theirs:
            argument = json.dumps({"descriptor": theirs.fileno(), "speed": audience.speed})
            yield argument, (theirs.fileno(),)
    finally:
        listener.join()


def _listen(ours: socket.socket, audience: Audience) -> None:
    """Pass on the news until the other end is closed."""
    pause = threading.Event()
    text, is_whole = b"", False
    try:
        with ours:  # the simulator does not wait for an audience that has left
            while len(text) < LONGEST_BYTES and (chunk := _more(ours)):
                *lines, text = (text + chunk).split(b"\n")
                news = [json.loads(line) for line in lines]
                audience.hear([each for each in news if "over" not in each])
                is_whole = bool(news) and "over" in news[-1]
                if len(chunk) < CHUNK_BYTES and not is_whole:
                    pause.wait(TOGETHER_S)
    finally:
        audience.ends(is_whole)


def _more(ours: socket.socket) -> bytes:
    try:
        return ours.recv(CHUNK_BYTES)
    except ConnectionError:
        return b""


# Its start ------------------------------------------------------------------------------------


@contextmanager
def start_simulator(
    module: str,
    context: RunContext,
    plan: Plan,
    shared: Sequence[int] = (),
    *more: str,
    server: ForkServer | None = None,
    feed: LiveFeed = ("", ()),
) -> Iterator[Simulator]:
    """Start `module` as the simulator's process.

    Args:
        shared: descriptors that it inherits as well.
        more: further arguments.
        server: the server that it is forked from, if possible.
        feed: for its live reports on the run; its argument comes last.
    """
    ours, theirs = socket.socketpair()
    with ours:
        with theirs:
            # /proc/self is the simulator's by then
            recording = f"/proc/self/fd/{context.recording}"
            here = Path(f"/proc/self/fd/{context.simulator_folder}")
            fds = (theirs.fileno(), *shared, context.recording, context.simulator_folder)
            words = [str(theirs.fileno()), recording, plan.to_json(), *more, feed[0]]
            command = ProcessCommand(
                [sys.executable, "-m", module, *words],
                simulator_environment(context.env),
                here,
                (*fds, *feed[1]),
                context.namespaces,
                needs=plan.scene,
            )
            process = StartedProcess(command, server)
        with process.ended_at_exit():
            yield Simulator(process, ours)
