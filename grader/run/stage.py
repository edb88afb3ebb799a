"""What a run stands on while it lasts, in real time as in virtual time."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from grader import scratch
from grader.run.environment import environment
from grader.run.processes import isolation
from grader.run.processes.watched import Student
from grader.submission.opening import EntryPoint, Submission


def target(submission: Submission) -> list[str]:
    """What of a submission is started, as arguments of its process's `main`."""
    start = submission.start
    if isinstance(start, EntryPoint):
        words = [f"{start.module}:{start.function}"]
    else:
        words = [str(start.path), *([start.function] if start.function else [])]
    return [str(submission.root), *words]


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
def open_stage() -> Iterator[Stage]:
    """Set one up; nothing of it is left afterwards.

    Raises:
        GraderFailure: it cannot be isolated from other runs.
    """
    with scratch.make_folder() as folder, isolation.obtain_isolation(folder) as isolated:
        env = environment(folder, isolated.env)
        recording = os.memfd_create("recording")
        try:
            yield Stage(folder, recording, isolated.name, env, isolated.entry)
        finally:
            os.close(recording)
