"""What a run in real time and one in virtual time have in common: the grader's side of both."""

from __future__ import annotations

import json
import os
import pickle
import selectors
import socket
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import grader
from grader.errors import GraderFailure
from grader.exercise import Limits
from grader.recording import Outcome, Recording, Start
from grader.run import isolation, scratch
from grader.run.processes import Student, Watched, adopt_orphans
from grader.submission import EntryPoint, Submission

#: How long the simulator may take to come up, and to save the recording [s].
SIMULATOR_PATIENCE_S = 60.0

#: Variables that change how ROS or Python works: the user's are not for graded runs ...
PERSONAL = ("CYCLONEDDS_", "FASTDDS_", "FASTRTPS_", "PYTHON", "RCL_", "RCUTILS_", "RMW_", "ROS_")
#: ... but for those that tell which ROS there is.
KEPT = ("ROS_DISTRO", "ROS_PYTHON_CHECK_FIELDS", "ROS_PYTHON_VERSION", "ROS_VERSION")

Message = dict[str, Any]


def target(submission: Submission) -> list[str]:
    """What of a submission is started, as arguments of `student_main` and `host.main`."""
    start = submission.start
    if isinstance(start, EntryPoint):
        words = [f"{start.module}:{start.function}"]
    else:
        words = [str(start.path), *([start.function] if start.function else [])]
    return [str(submission.root), *words]


def environment(folder: Path, isolated: Mapping[str, str]) -> dict[str, str]:
    """Environment variables for both processes of a run: nothing of the user's that changes it.

    Args:
        folder: where ROS may log, and temporary files go.
        isolated: what the isolation adds.
    """
    env = {
        name: value
        for name, value in os.environ.items()
        if name in KEPT or not name.startswith(PERSONAL)
    }
    if is_ros_sourced() and "PYTHONPATH" in os.environ:
        env["PYTHONPATH"] = os.environ["PYTHONPATH"]  # ROS's own packages are there
    (folder / "tmp").mkdir()
    return {
        **env,
        **isolated,
        "ROS_LOG_DIR": str(folder / "log"),
        "TMPDIR": str(folder / "tmp"),
        "SKIP_DEFAULT_XML": "1",  # Fast DDS reads no profile that lies in the current folder
        "LC_ALL": "C.UTF-8",
        "PYTHONUTF8": "1",
        "PYTHONUNBUFFERED": "1",
        "PYTHONDONTWRITEBYTECODE": "1",
    }


def is_ros_sourced() -> bool:
    """Whether ROS comes from the user's shell rather than from PyPI."""
    return "ROS_DISTRO" in os.environ


def simulator_environment(env: Mapping[str, str]) -> dict[str, str]:
    """The simulator finds our own packages first, and nothing that lies about."""
    ours = str(Path(grader.__file__).parents[1])
    path = os.pathsep.join(filter(None, [ours, env.get("PYTHONPATH", "")]))
    return {**env, "PYTHONPATH": path, "PYTHONSAFEPATH": "1"}


@dataclass(frozen=True)
class Stage:
    """What a run stands on while it lasts.

    Attributes:
        folder: the current folder of the simulator.
        recording: a file without a name where the simulator leaves the recording. The submission
            does not get it: whoever writes a pickle has the grader do as he likes.
        isolation: for the result.
        env: environment variables of both processes.
        entry: stands before the command of each.
    """

    folder: Path
    recording: int
    isolation: str
    env: Mapping[str, str]
    entry: tuple[str, ...]

    def student(
        self,
        command: Sequence[str],
        submission: Submission,
        pass_fds: tuple[int, ...] = (),
        more_env: Mapping[str, str] | None = None,
    ) -> Student:
        """Start the submission's process in its own folder."""
        env = {**self.env, **(more_env or {})}
        return Student(command, env, submission.root, pass_fds, self.entry)


@contextmanager
def stage() -> Iterator[Stage]:
    """Set one up; nothing of it is left afterwards.

    Raises:
        GraderFailure: it cannot be isolated from other runs.
    """
    adopt_orphans()
    with scratch.folder() as folder, isolation.obtained(folder) as isolated:
        env = environment(folder, isolated.env)
        recording = os.memfd_create("recording")
        try:
            yield Stage(folder, recording, isolated.name, env, isolated.entry)
        finally:
            os.close(recording)


def outcome(reason: str, exit_code: int | None) -> Outcome:
    """How a run ended: what the simulator saw, and how the submission's process ended."""
    if exit_code is None:
        return "finished" if reason == "rest" else "time_limit"
    if exit_code < 0:
        return "killed"
    if exit_code > 0:
        return "crashed"
    return "finished" if reason == "rest" else "exited"


def leave(recording: Recording, path: Path) -> None:
    """In the simulator's process: leave the recording for the grader."""
    path.write_bytes(pickle.dumps(recording))


def fetch(stage: Stage, start: Start | None, output: str) -> Recording:
    """In the grader's process: the recording that the simulator left."""
    with open(stage.recording, "rb", closefd=False) as file:
        file.seek(0)
        recording: Recording = pickle.load(file)
    return replace(recording, start=start, output=output)


class Simulator:
    """The simulator's process, and the line to it."""

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
        while (message := self.next(0.2)) is None:
            if time.monotonic() > deadline:
                raise self.failure(f"did not say {what!r} in {SIMULATOR_PATIENCE_S:.0f} s")
        if message["say"] != what:
            raise self.failure(f"said {message!r} where {what!r} was expected")

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
        state = "it still runs" if code is None else f"its exit code is {code}"
        last = self._process.output().strip() or "(it printed nothing)"
        return GraderFailure(f"the simulator {what}; {state}. Its last words:\n{last[-2000:]}")


@contextmanager
def simulator(
    module: str,
    stage: Stage,
    limits: Limits,
    start: Start | None,
    link: socket.socket | None = None,
    *more: str,
) -> Iterator[Simulator]:
    """Start `module` as the simulator's process.

    Args:
        start: where turtle1 stands at first; None for its usual place.
        link: inherited as well; its number follows the first four arguments.
        more: further arguments.
    """
    ours, theirs = socket.socketpair()
    with ours:
        with theirs:
            fds = [theirs.fileno(), *([link.fileno()] if link else [])]
            file = f"/proc/self/fd/{stage.recording}"
            words = [
                *(str(fds[0]), file, json.dumps(asdict(limits))),
                json.dumps(asdict(start) if start else None),
                *map(str, fds[1:]),
                *more,
            ]
            command = [*stage.entry, sys.executable, "-m", module, *words]
            env = simulator_environment(stage.env)
            process = Watched(command, env, stage.folder, (*fds, stage.recording))
        try:
            yield Simulator(process, ours)
        finally:
            process.end()
