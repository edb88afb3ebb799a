"""The run context: what a run is given while it lasts, in real time as in virtual time."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from grader import scratch
from grader.run.environment import environment
from grader.run.limits import CpuBudget
from grader.run.processes import isolation, levels
from grader.run.processes.fork_server import ForkServer
from grader.run.processes.fork_server_main import ProcessCommand
from grader.run.processes.started_process import SubmissionProcess
from grader.submission.start import EntryPoint, Launch, Submission, Whole


@dataclass(frozen=True)
class RunContext:
    """What a run is given while it lasts.

    Attributes:
        folder: where the files of the run are, as far as its processes know.
        simulator_folder: the same as the current folder of the simulator: an open folder, which
            stays one where a submission that may do so takes it away.
        recording: where the simulator leaves the recording: an open file without a name. The
            submission does not get it.
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
    isolation: str
    env: Mapping[str, str]
    namespaces: Mapping[str, int]
    level: levels.Level
    budget: CpuBudget

    def start(
        self,
        submission: Submission,
        words: Callable[[Submission], Sequence[str]],
        fds: tuple[int, ...],
        env: Mapping[str, str],
        server: ForkServer | None = None,
    ) -> tuple[Submission, SubmissionProcess]:
        """Start the submission's process; the submission is the one that this run has for itself.

        Args:
            words: makes the command of that process.
            fds: descriptors that it inherits.
            env: environment variables beside those of both processes.
            server: what it is forked from, if that can be; None: it starts from nothing.
        """
        is_apart = bool(self.namespaces)
        confinement = levels.prepare(self.level, submission.folder, self.folder, is_apart=is_apart)
        submission = submission.moved(confinement.copy)
        env = {**self.env, **env, **confinement.env}
        command = ProcessCommand(
            words(submission), env, submission.root, fds, self.namespaces, confinement.order
        )
        return submission, SubmissionProcess(command, server, self.budget)


@contextmanager
def open_context(budget: CpuBudget | None = None) -> Iterator[RunContext]:
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
            recording = os.memfd_create("recording")
            stack.callback(os.close, recording)
            yield RunContext(
                *(folder, simulator_folder, recording, isolation_name, env),
                *(isolated.namespaces, level, budget or CpuBudget()),
            )


def start_arguments(submission: Submission) -> list[str]:
    """What of a submission is started, as arguments of its process's `main`."""
    start = submission.start
    if isinstance(start, Launch):
        words = [json.dumps([[p.name, _entry(p.entry), p.arguments] for p in start.programs])]
    elif isinstance(start, EntryPoint):
        words = [_entry(start)]
    elif isinstance(start, Whole):
        raise ValueError("nothing of this submission is started")
    else:
        words = [str(start.path), *([start.function] if start.function else [])]
    return [str(submission.root), *words]


def _entry(entry: EntryPoint) -> str:
    return f"{entry.module}:{entry.function}"
