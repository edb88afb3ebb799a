"""A graded run in real time: the wall clock moves the scene while the submission drives it."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

from grader import usage
from grader.errors import GraderFailure, NotNow
from grader.recording.recording import Recording
from grader.run import evidence, handover, stage
from grader.run.audience import Audience, seats
from grader.run.environment import student_environment
from grader.run.finish import ended, outcome, record
from grader.run.lost import SimulatorLost
from grader.run.plan import Plan
from grader.run.processes.watched import Watched
from grader.run.simulator_process import Message, Simulator, start_simulator
from grader.scenes import load_scene
from grader.scenes.scene import Introduction
from grader.submission.opening import Launch, Submission

#: Told the simulated time [s] now and then.
Progress = Callable[[float], None]

#: A program that used so much of the run's time on a processor has computed rather than waited.
COMPUTES = 0.5
#: How long the clock of the run waits for the submission's first node [s].
FIRST_NODE_S = 8.0
#: Where what runs as the submission's process is.
STUDENT = Path(__file__).with_name("student")
#: What runs as the simulator's process.
MODULE = "grader.run.simulator.real_time"


def run(
    submission: Submission,
    plan: Plan,
    progress: Progress | None = None,
    audience: Audience | None = None,
    first_node_s: float = FIRST_NODE_S,
) -> Recording:
    """Run a submission once beside a simulator of its own.

    Args:
        progress: called about once a second with the simulated time [s].
        audience: who looks on; at no other speed than this.
        first_node_s: how long the clock of the run waits for its first node [s].

    Raises:
        GraderFailure: the simulator could not be started.
        SimulatorLost: it died beside the submission.
    """
    started = time.monotonic()
    scene = load_scene(plan.scene)
    with (
        stage.open_stage(plan.budget) as place,
        evidence.open_evidence() as told,
        seats(audience, plan, "real") as seat,
        start_simulator(MODULE, place, plan, None, str(first_node_s), seat=seat) as simulator,
    ):
        seat.taken()
        simulator.expect("ready")
        submission, student = place.start(
            submission,
            lambda own: command(own, scene.introduction, told.page),
            (told.page,),
            student_environment({}),
        )
        ending = partial(ended, "real", submission, student, place.isolation, started)
        began_s = time.monotonic()
        try:
            try:
                done, exit_code, ended_s = _watch(simulator, student, progress)
                ended_s -= began_s
                computes = usage.look(student.pid).cpu_s > COMPUTES * ended_s
                if exit_code is None:
                    told.ask(student.pid)
                told.close()  # what comes then is how it ends when it is told to
            finally:
                student.end()
            trace, topics = handover.fetch(place.recording, scene)
        except NotNow:  # it was never started
            raise
        except GraderFailure as failure:
            raise SimulatorLost(failure, ending("killed", None)) from failure
    how = outcome(done["reason"], exit_code)
    conduct = told.conduct(submission, ended_s, computes=computes)
    return record(plan, trace, topics, ending(how, exit_code, tuple(done["flags"])), conduct)


def command(submission: Submission, introduction: Introduction, page: int) -> list[str]:
    """How the submission's process is started."""
    awaited = json.dumps([introduction.topics, introduction.services])
    words = [awaited, str(page), *stage.target(submission)]
    program = "launched.py" if isinstance(submission.start, Launch) else "main.py"
    return [sys.executable, str(STUDENT / program), *words]


def _watch(
    simulator: Simulator, student: Watched, progress: Progress | None
) -> tuple[Message, int | None, float]:
    """Start the clock of the run, wait for its end: how it came, the student's exit code, and when.

    When the student's process ended, or the run: on the machine's monotonic clock [s].
    """
    simulator.say("start")
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
            simulator.say("exited")
