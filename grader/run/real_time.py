"""A graded run in real time: the wall clock moves the scene while the submission drives it."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from contextlib import ExitStack, closing
from dataclasses import replace
from functools import partial
from pathlib import Path

from grader import linux
from grader.cast import script
from grader.errors import GraderFailure, NotNow, SceneFailure
from grader.message import Message
from grader.recording.recording import Recording
from grader.run import compiling, handover, run_context
from grader.run.environment import student_environment
from grader.run.evidence import EvidencePage
from grader.run.finish import SimulatorLost, ended, not_run, outcome, record
from grader.run.handover import Plan
from grader.run.limits import FIRST_NODE_S
from grader.run.processes.started_process import SubmissionProcess
from grader.run.simulator_process import (
    Audience,
    Simulator,
    SimulatorMessage,
    live_feed,
    start_simulator,
)
from grader.scenes import load_scene
from grader.scenes.scene import Introduction
from grader.submission.start import Submission

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
    scene = load_scene(plan.scene)
    with (
        run_context.open_context(plan.budget) as context,
        closing(EvidencePage()) as account,
        live_feed(audience, plan, "real") as feed,
        ExitStack() as stack,
    ):
        try:
            # of a cast the simulator's process hears the submission's own
            known = {**plan.own_definitions, **plan.definitions}
            ours, theirs = compiling.compile_all(known, submission.interfaces, context)
        except compiling.NotCompiled as why:
            return not_run(plan, why.message)
        its = replace(context, env={**context.env, **ours.env})
        simulator = stack.enter_context(
            start_simulator(MODULE, its, plan, (), str(FIRST_NODE_S), feed=feed)
        )
        simulator.expect("ready")
        submission, student = context.start(
            submission,
            lambda private: command(private, scene.introduction, plan, account.page),
            (account.page,),
            student_environment(theirs.env),
            more=theirs.folders,
        )
        ending = partial(ended, "real", submission, student, context.isolation, started)
        began_s = time.monotonic()
        try:
            with student.ended_at_exit():
                done, exit_code, ended_s = _watch(simulator, student, progress)
                ended_s -= began_s
                computes = linux.process_stat(student.pid).cpu_s > COMPUTES * ended_s
                if exit_code is None:
                    account.request_dump(student.pid)
                account.close()  # later entries are only about the end that we ask for
            trace, topics = handover.fetch(context.recording, handover.keeper(plan, scene))
        except (NotNow, SceneFailure):  # it was never started, or is not to blame
            raise
        except GraderFailure as failure:
            raise SimulatorLost(failure, ending("killed", None)) from failure
    how = outcome(done["reason"], exit_code)
    observations = account.observations(submission, ended_s, computes=computes)
    flags = tuple(map(Message.parse, done["flags"]))
    return record(plan, trace, topics, ending(how, exit_code, flags), observations)


def command(submission: Submission, introduction: Introduction, plan: Plan, page: int) -> list[str]:
    """Return the command of the submission's process."""
    heard = [] if plan.cast is None else script.heard(script.parse(plan.cast), plan.hears)
    topics = [*introduction.topics, *heard]
    introduced = json.dumps([topics, introduction.services, plan.arguments])
    words = [introduced, str(page), *run_context.start_arguments(submission)]
    return [sys.executable, str(STUDENT / "main.py"), *words]


def _watch(
    simulator: Simulator, student: SubmissionProcess, progress: Progress | None
) -> tuple[SimulatorMessage, int | None, float]:
    """Start the clock of the run and wait for its end.

    Returns:
        The simulator's last message; the exit code of the submission's process; when that, or the
        run, ended, on the machine's monotonic clock [s].
    """
    simulator.send("start")
    exit_code: int | None = None
    ended_s = 0.0
    while True:
        message = simulator.next(0.05)
        if message and message["say"] == "done":
            return message, exit_code, ended_s or time.monotonic()
        if message and progress:
            progress(message["seconds"])
        if exit_code is None and (exit_code := student.poll()) is not None:
            ended_s = time.monotonic()
            simulator.send("exited")
