"""A graded run in real time: the wall clock moves the turtle while the submission drives it."""

from __future__ import annotations

import json
import os
import selectors
import socket
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from grader import recording as recordings
from grader.errors import GraderFailure
from grader.exercise import Limits
from grader.recording import Outcome, Recording
from grader.run import domain, student_main
from grader.run.processes import Watched, adopt_orphans
from grader.submission import EntryPoint, Submission

#: How long the simulator may take to come up, and to save the recording [s].
SIMULATOR_PATIENCE_S = 60.0


def run(
    submission: Submission, limits: Limits, progress: Callable[[float], None] | None = None
) -> Recording:
    """Run a submission once beside a simulator of its own.

    Args:
        progress: called about once a second with the simulated time [s].

    Raises:
        GraderFailure: the simulator could not be started or died.
    """
    adopt_orphans()
    started = time.monotonic()
    with domain.reserved() as domain_id, tempfile.TemporaryDirectory() as scratch:
        env = _environment(domain_id, Path(scratch))
        folder = Path(scratch) / "recording"
        with _simulator(env, folder, limits) as simulator:
            simulator.expect("ready")
            student = Watched(command(submission), env, cwd=submission.root)
            try:
                reason, exit_code = simulator.watch(student, progress)
            finally:
                student.end()
        outcome = _outcome(reason, exit_code)
        recorded = recordings.load(folder)
    return replace(recorded, output=student.output()).finished(
        ticks=recorded.run.ticks,
        time="real",
        outcome=outcome,
        exit_code=exit_code,
        wall_s=round(time.monotonic() - started, 3),
        isolation=f"ROS domain {domain_id}",
    )


def command(submission: Submission) -> list[str]:
    """How the submission's process is started."""
    start = submission.start
    if isinstance(start, EntryPoint):
        target = [f"{start.module}:{start.function}"]
    else:
        target = [str(start.path), *([start.function] if start.function else [])]
    return [sys.executable, student_main.__file__, str(submission.root), *target]


def _environment(domain_id: int, scratch: Path) -> dict[str, str]:
    return {
        **os.environ,
        "ROS_DOMAIN_ID": str(domain_id),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_LOG_DIR": str(scratch / "log"),
        "PYTHONUNBUFFERED": "1",
        "PYTHONDONTWRITEBYTECODE": "1",
    }


def _outcome(reason: str, exit_code: int | None) -> Outcome:
    if exit_code is None:
        return "finished" if reason == "rest" else "time_limit"
    if exit_code < 0:
        return "killed"
    if exit_code > 0:
        return "crashed"
    return "finished" if reason == "rest" else "exited"


class _Link:
    """The grader's end of the line to the simulator."""

    def __init__(self, process: Watched, ours: socket.socket) -> None:
        self._process = process
        self._socket = ours
        self._text = b""

    def expect(self, what: str) -> None:
        """Wait for a message.

        Raises:
            GraderFailure: another one comes, none comes in time, or the simulator dies.
        """
        deadline = time.monotonic() + SIMULATOR_PATIENCE_S
        while (message := self._next(0.2)) is None:
            if time.monotonic() > deadline:
                raise self._failure(f"did not say {what!r} in {SIMULATOR_PATIENCE_S:.0f} s")
        if message["say"] != what:
            raise self._failure(f"said {message!r} where {what!r} was expected")

    def watch(
        self, student: Watched, progress: Callable[[float], None] | None
    ) -> tuple[str, int | None]:
        """Start the clock of the run, wait for its end; the reason and the student's exit code."""
        self._say("start")
        exit_code: int | None = None
        while True:
            message = self._next(0.05)
            if message and message["say"] == "done":
                return message["reason"], exit_code
            if message and progress:
                progress(message["seconds"])
            if exit_code is None and (exit_code := student.poll()) is not None:
                self._say("exited")

    def _say(self, what: str) -> None:
        try:
            self._socket.sendall(json.dumps({"say": what}).encode() + b"\n")
        except OSError:
            raise self._failure("stopped listening") from None

    def _next(self, patience_s: float) -> dict[str, Any] | None:
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
                raise self._failure("died")
            self._text += chunk
            return None
        line, _, self._text = self._text.partition(b"\n")
        message: dict[str, Any] = json.loads(line)
        return message

    def _failure(self, what: str) -> GraderFailure:
        code = self._process.wait(2.0)
        state = "it still runs" if code is None else f"its exit code is {code}"
        last = self._process.output().strip() or "(it printed nothing)"
        return GraderFailure(f"the simulator {what}; {state}. Its last words:\n{last[-2000:]}")


@contextmanager
def _simulator(env: Mapping[str, str], folder: Path, limits: Limits) -> Iterator[_Link]:
    ours, theirs = socket.socketpair()
    with ours:
        with theirs:
            words = [str(theirs.fileno()), str(folder), json.dumps(asdict(limits))]
            process = Watched(
                [sys.executable, "-m", "grader.run.simulator", *words],
                env,
                pass_fds=(theirs.fileno(),),
            )
        try:
            yield _Link(process, ours)
        finally:
            process.end()
