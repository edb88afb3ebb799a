"""What a run stands on while it lasts, in real time as in virtual time."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from grader import scratch
from grader.run.budget import Budget
from grader.run.environment import environment
from grader.run.processes import isolation, levels
from grader.run.processes.family import Student
from grader.run.processes.sandbox.confinement import NAMESPACES
from grader.run.processes.watched import Watched
from grader.run.processes.zygote import Zygote
from grader.submission.opening import EntryPoint, Launch, Submission, Whole


def target(submission: Submission) -> list[str]:
    """What of a submission is started, as arguments of its process's `main`."""
    start = submission.start
    if isinstance(start, Launch):
        words = [json.dumps([[p.name, _words(p.entry), p.arguments] for p in start.programs])]
    elif isinstance(start, EntryPoint):
        words = [_words(start)]
    elif isinstance(start, Whole):
        raise ValueError("nothing of this submission is started")
    else:
        words = [str(start.path), *([start.function] if start.function else [])]
    return [str(submission.root), *words]


def _words(entry: EntryPoint) -> str:
    return f"{entry.module}:{entry.function}"


def not_in_virtual_time(submission: Submission) -> str:
    """What of its start virtual time cannot follow, to complete "because ..."; '' if nothing."""
    if not isinstance(submission.start, Launch):
        return ""
    names = ", ".join(each.name for each in submission.start.programs)
    return f"several programs were started, each in a process of its own: {names}"


@dataclass(frozen=True)
class Stage:
    """What a run stands on while it lasts.

    Attributes:
        folder: where the files of the run are, as far as its processes know.
        simulator_folder: the same as the current folder of the simulator: an open folder, which
            stays one where a submission that may do so takes it away.
        recording: where the simulator leaves the recording: an open file without a name. The
            submission does not get it.
        recording_path: what opens it in the simulator's process.
        isolation: for the result: how the submission's process is confined, and what keeps the
            run apart from others.
        env: environment variables of both processes.
        namespaces: which both processes are in: kind -> descriptor.
        level: how the submission's process is confined.
        budget: what the submission's process and all that it starts spend of.
    """

    folder: Path
    simulator_folder: int
    recording: int
    recording_path: str
    isolation: str
    env: Mapping[str, str]
    namespaces: Mapping[str, int]
    level: levels.Level
    budget: Budget

    def start(
        self,
        submission: Submission,
        command: Callable[[Submission], Sequence[str]],
        pass_fds: tuple[int, ...],
        env: Mapping[str, str],
        zygote: Zygote | None = None,
    ) -> tuple[Submission, Watched]:
        """Start the submission's process; the submission is the one that this run has for itself.

        Args:
            command: says how that is started.
            env: environment variables beside those of both processes.
            zygote: what it is forked from, if that can be; None: it starts from nothing.
        """
        if self.level.level != NAMESPACES:  # there the process copies it
            submission = submission.again(self.folder / "submission")
        root = submission.root
        own = submission.copy.folder if submission.copy else root
        place = levels.prepare(self.level, root, own, self.folder, is_apart=bool(self.namespaces))
        env = {**self.env, **env, **place.env}
        words = (command(submission), env, root, pass_fds, self.namespaces, zygote, place.order)
        return submission, Student(*words, budget=self.budget)


@contextmanager
def open_stage(budget: Budget | None = None) -> Iterator[Stage]:
    """Set one up; nothing of it is left afterwards.

    Args:
        budget: of the grading; None for one without an end.

    Raises:
        GraderFailure: it cannot be isolated from other runs, or confined as was required.
    """
    with scratch.make_folder() as folder, isolation.obtain_isolation(folder) as isolated:
        level = levels.best(isolated)
        isolation_name = ", ".join(filter(None, [level.name(), isolated.name]))
        env = environment(folder, isolated.env)
        with ExitStack() as stack:
            simulator_folder = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
            stack.callback(os.close, simulator_folder)
            recording, path = _make_recording()
            stack.callback(os.close, recording)
            yield Stage(
                *(folder, simulator_folder, recording, path, isolation_name, env),
                *(isolated.namespaces, level, budget or Budget()),
            )


def _make_recording() -> tuple[int, str]:
    """An open file for the recording, and what opens it in a process that we start."""
    descriptor = os.memfd_create("recording")
    return descriptor, f"/proc/self/fd/{descriptor}"
