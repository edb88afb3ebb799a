"""The run context: the folder, isolation, environment and budget of one run, by either clock."""

from __future__ import annotations

import json
import os
import socket
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from grader.recording.recording import MOST_PROGRAMS
from grader.run.environment import environment
from grader.run.limits import CpuBudget
from grader.run.processes import levels, network
from grader.run.processes.fork_server import ForkServer
from grader.run.processes.fork_server_main import ProcessCommand
from grader.run.processes.started_process import SubmissionProcess
from grader.run.student.loading import ProgramStart
from grader.submission.program import Script
from grader.submission.start import Submission
from grader.system import scratch


@dataclass(frozen=True)
class RunContext:
    """The resources of one run.

    Attributes:
        folder: the folder of the run's files, by the path that its processes know.
        simulator_folder: a descriptor of it, for the current folder of the simulator: that stays
            usable even where a submission may move the folder, and does.
        recording: the file for the simulator's recording: an open file without a name. The
            submission does not get it.
        isolation: for the result: how the submission's process is confined, and what keeps the
            run apart from others.
        env: environment variables of both processes.
        namespaces: the namespaces of both processes: kind -> descriptor.
        level: how the submission's process is confined.
        budget: what the submission's process and all that it starts spend of.
        meeting: the ends of a socket, by which its programs share one view of the files: that of
            the first, and that of the others.
    """

    folder: Path
    simulator_folder: int
    recording: int
    isolation: str
    env: Mapping[str, str]
    namespaces: Mapping[str, int]
    level: levels.Level
    budget: CpuBudget
    meeting: tuple[socket.socket, socket.socket]

    def start(
        self,
        submission: Submission,
        words: Callable[[Submission], Sequence[str]],
        fds: tuple[int, ...],
        env: Mapping[str, str],
        server: ForkServer | None = None,
        *,
        more: Sequence[Path] = (),
        beside: SubmissionProcess | None = None,
    ) -> tuple[Submission, SubmissionProcess]:
        """Start the submission's process; return it after the submission's copy for this run.

        Args:
            words: makes the command of that process.
            fds: descriptors that it inherits.
            env: environment variables beside those of both processes.
            server: the server that it is forked from, if possible; None for a cold start.
            more: folders that it may read besides.
            beside: another of the submission's, with which it shares the limits.
        """
        meeting = self.meeting[0 if beside is None else 1]
        confinement = levels.prepare(
            self.level,
            submission.folder,
            self.folder,
            is_apart=bool(self.namespaces),
            more=more,
            meeting=meeting.fileno(),
            others=MOST_PROGRAMS - 1 if beside is None else 0,
        )
        submission = submission.moved(confinement.copy)
        env = {**submission.environment, **self.env, **env, **confinement.env}
        if submission.installed:
            places = filter(None, (submission.installed, env.get("AMENT_PREFIX_PATH")))
            env["AMENT_PREFIX_PATH"] = os.pathsep.join(places)
        if "meeting" in (confinement.order or ()):
            fds = (*fds, meeting.fileno())
        command = ProcessCommand(
            words(submission), env, submission.root, fds, self.namespaces, confinement.order
        )
        process = SubmissionProcess(command, server, self.budget, beside)
        if beside is None:
            meeting.close()  # the others notice its end
        return submission, process


@contextmanager
def open_context(budget: CpuBudget | None = None) -> Iterator[RunContext]:
    """Set up a run context, which is removed at the end.

    Args:
        budget: of the grading; None for an unlimited one.
    """
    with scratch.make_folder() as folder, network.obtain_isolation(folder) as isolated:
        level = levels.best(isolated)
        isolation_name = ", ".join(filter(None, [level.name(), isolated.name]))
        env = environment(folder, isolated.env)
        with ExitStack() as stack:
            simulator_folder = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
            stack.callback(os.close, simulator_folder)
            recording = os.memfd_create("recording")
            stack.callback(os.close, recording)
            ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
            stack.callback(theirs.close)
            stack.callback(ours.close)
            yield RunContext(
                *(folder, simulator_folder, recording, isolation_name, env),
                *(isolated.namespaces, level, budget or CpuBudget(), (ours, theirs)),
            )


def start_of(submission: Submission, arguments: Sequence[str]) -> str:
    """Return the start of a submission of one program, as its process gets it.

    Args:
        arguments: those that follow the program's own.
    """
    (program,) = submission.programs
    entry = program.entry
    assert entry is not None
    target = str(entry.path) if isinstance(entry, Script) else entry.module
    words = submission.words((*program.arguments, *arguments))
    beside = [str(folder) for folder in submission.beside]
    start = ProgramStart(str(submission.root), target, entry.function or None, words, beside)
    return json.dumps(start)
