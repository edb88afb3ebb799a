"""A graded run in real time: the wall clock moves the scene while the submission drives it."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path

from grader.errors import GraderFailure, NotNow, SceneFailure
from grader.recording.recording import Recording
from grader.run import compiling, fork_servers, handover, run_context
from grader.run.environment import student_environment
from grader.run.evidence import EvidencePage
from grader.run.finish import (
    ProgramEnd,
    RunningProgram,
    SimulatorLost,
    ending_of,
    not_run,
    observations_of,
    outcome,
    record,
)
from grader.run.handover import Plan
from grader.run.limits import FIRST_NODE_S
from grader.run.run_context import RunContext
from grader.run.simulator_process import (
    Audience,
    Simulator,
    SimulatorMessage,
    live_feed,
    start_simulator,
)
from grader.scenes.cast import script
from grader.scenes.scene import Introduction, Reason, load_scene
from grader.submission.program import Program
from grader.submission.start import Submission
from grader.system import linux
from grader.system.requirements import missing_ros
from grader.text.message import Message

#: Called with the simulated time [s] now and then.
Progress = Callable[[float], None]

#: A program that used this share of the run's time on a processor has computed, not waited.
COMPUTES = 0.5
#: The folder of the program that runs as the submission's process.
STUDENT = Path(__file__).with_name("student")
#: The module that runs as the simulator's process.
MODULE = "grader.run.simulator.real_time"


def run(
    submission: Submission,
    plan: Plan,
    progress: Progress | None = None,
    audience: Audience | None = None,
) -> Recording:
    """Run a submission once beside a simulator of its own.

    Args:
        progress: called about once a second with the simulated time [s].
        audience: receives the run live, at no other speed than this.

    Raises:
        GraderFailure: the simulator could not be started.
        SceneFailure: the scene raised an exception.
        SimulatorLost: it died beside the submission.
    """
    started = time.monotonic()
    if lack := missing_ros("real"):
        return not_run(plan, lack.message)
    with (
        run_context.open_context(plan.budget) as context,
        live_feed(audience, plan, "real") as feed,
        ExitStack() as stack,
    ):
        try:
            # of a cast the simulator's process hears the submission's own
            known = {**plan.own_definitions, **plan.definitions}
            ours, theirs = compiling.compile_all(known, submission.interfaces, context)
        except compiling.NotCompiled as why:
            return not_run(plan, why.message)
        its = replace(context, env={**context.env, **compiling.importing(ours, context)})
        # where interfaces were compiled, libraries have to be found that the server does not know
        server = None if ours else fork_servers.server(fork_servers.SIMULATOR)
        simulator = stack.enter_context(
            start_simulator(MODULE, its, plan, (), str(FIRST_NODE_S), server=server, feed=feed)
        )
        simulator.expect("ready")
        programs = _Programs(submission, plan, context, theirs, stack)
        programs.start_due(0.0)
        try:
            with programs.ended_at_exit():
                done = _watch(simulator, programs, progress)
                ends = programs.ends(done["reason"])
            recorded = handover.fetch(context.recording, handover.keeper(plan, programs.scene))
        except (NotNow, SceneFailure):  # it was never started, or is not to blame
            raise
        except GraderFailure as failure:
            what_ran = (programs.in_order, context.isolation, started)
            raise SimulatorLost(failure, "real", *what_ran) from failure
        flags = tuple(map(Message.parse, done["flags"]))
        running = programs.in_order
        ending = ending_of("real", running, ends, context.isolation, started, flags)
        return record(plan, *recorded, ending, observations_of(running, ends))


class _Programs:
    """The programs of a submission, each started when it is its turn.

    Attributes:
        running: those that were started, by their places among all.
    """

    def __init__(
        self,
        submission: Submission,
        plan: Plan,
        context: RunContext,
        interfaces: Path | None,
        held: ExitStack,
    ) -> None:
        self.scene = load_scene(plan.scene)
        self.running: dict[int, RunningProgram] = {}
        self._ended: dict[int, tuple[int, float]] = {}  # exit codes, and when [s]
        self._submission, self._plan, self._context = submission, plan, context
        self._interfaces, self._held = interfaces, held
        self.began_s = time.monotonic()

    @property
    def in_order(self) -> list[RunningProgram]:
        """Those that were started, in the order of the launch."""
        return [self.running[number] for number in sorted(self.running)]

    def start_due(self, now_s: float) -> None:
        """Start those whose turn has come."""
        for number, program in enumerate(self._submission.programs):
            at_s = self._starts_at(program)
            if number in self.running or at_s is None or at_s > now_s:
                continue
            account = self._held.enter_context(closing(EvidencePage()))
            moved, process = self._context.start(
                self._submission.alone(program),
                partial(command, self.scene.introduction, self._plan, account.page),
                (account.page,),
                student_environment(compiling.importing(self._interfaces, self._context)),
                more=[self._interfaces] if self._interfaces else (),
                beside=next((each.process for each in self.running.values()), None),
            )
            self.running[number] = RunningProgram(program, moved, process, account)

    def _starts_at(self, program: Program) -> float | None:
        """When it is to start [s]; None where that is not known yet."""
        if program.after < 0:
            return program.delay_s
        ended = self._ended.get(program.after)
        return None if ended is None else ended[1] + program.delay_s

    @contextmanager
    def ended_at_exit(self) -> Iterator[None]:
        """End all when the context is left."""
        try:
            yield
        finally:
            for each in self.running.values():
                each.process.end()

    def have_ended(self) -> bool:
        """Whether all that could be started were, and have ended."""
        for number, each in self.running.items():
            if number not in self._ended and (code := each.process.wait(0.0)) is not None:
                self._ended[number] = code, time.monotonic() - self.began_s
        programs = enumerate(self._submission.programs)
        left = (p for number, p in programs if number not in self.running)
        is_through = all(self._starts_at(program) is None for program in left)
        return is_through and len(self._ended) == len(self.running)

    def ends(self, reason: Reason) -> list[ProgramEnd]:
        """Return how they have ended; those that still run are asked where they are."""
        now_s = time.monotonic() - self.began_s
        ends = []
        for number, each in sorted(self.running.items()):
            code, at_s = self._ended.get(number, (None, now_s))
            computes = linux.process_stat(each.process.pid).cpu_s > COMPUTES * at_s
            ends.append(ProgramEnd(outcome(reason, code), code, at_s, bool(code), computes))
            if code is None:
                each.account.request_dump(each.process.pid)
            each.account.close()  # later entries are only about the end that we ask for
        return ends


def command(introduction: Introduction, plan: Plan, page: int, submission: Submission) -> list[str]:
    """Return the command of a program's process."""
    heard = [] if plan.cast is None else script.heard(script.parse(plan.cast), plan.hears)
    introduced = json.dumps([[*introduction.topics, *heard], introduction.services])
    words = [str(page), introduced, run_context.start_of(submission, plan.arguments)]
    return [sys.executable, str(STUDENT / "main.py"), *words]


def _watch(
    simulator: Simulator, programs: _Programs, progress: Progress | None
) -> SimulatorMessage:
    """Start the clock of the run and wait for its end; return the simulator's last message."""
    simulator.send("start")
    programs.began_s = time.monotonic()
    has_ended = False
    while True:
        message = simulator.next(0.05)
        programs.start_due(time.monotonic() - programs.began_s)
        is_over = programs.have_ended()
        if message and message["say"] == "done":
            return message
        if message and progress:
            progress(message["seconds"])
        if is_over and not has_ended:
            has_ended = True
            simulator.send("exited")
