"""A graded run in real time: the wall clock moves the scene while the submission drives it."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable

from grader.errors import GraderFailure
from grader.recording.recording import Outcome, Recording
from grader.run import handover, stage
from grader.run.finish import Ending, limits_struck, outcome, record
from grader.run.lost import SimulatorLost
from grader.run.plan import Plan
from grader.run.processes.watched import Watched
from grader.run.simulator_process import Message, Simulator, start_simulator
from grader.run.student import main as student_main
from grader.scenes import load_scene
from grader.scenes.scene import Introduction
from grader.submission.opening import Submission

#: Told the simulated time [s] now and then.
Progress = Callable[[float], None]

#: What runs as the simulator's process.
MODULE = "grader.run.simulator.real_time"


def run(submission: Submission, plan: Plan, progress: Progress | None = None) -> Recording:
    """Run a submission once beside a simulator of its own.

    Args:
        progress: called about once a second with the simulated time [s].

    Raises:
        GraderFailure: the simulator could not be started.
        SimulatorLost: it died beside the submission.
    """
    started = time.monotonic()
    scene = load_scene(plan.scene)
    with stage.open_stage() as place, start_simulator(MODULE, place, plan) as simulator:
        simulator.expect("ready")
        submission = place.own(submission)
        student = place.student(command(submission, scene.introduction), submission)

        def ending(how: Outcome, exit_code: int | None, flags: tuple[str, ...] = ()) -> Ending:
            output = submission.as_handed_in(student.output())
            struck = limits_struck(exit_code, output, student.excess)
            return Ending(
                time="real",
                outcome=how,
                exit_code=exit_code,
                wall_s=time.monotonic() - started,
                isolation=place.isolation,
                output=output,
                flags=(*flags, *struck),
            )

        try:
            try:
                done, exit_code = _watch(simulator, student, progress)
            finally:
                student.end()
            trace, topics = handover.fetch(place.recording, scene)
        except GraderFailure as failure:
            raise SimulatorLost(failure, ending("killed", None)) from failure
    how = outcome(done["reason"], exit_code)
    return record(plan, trace, topics, ending(how, exit_code, tuple(done["flags"])))


def command(submission: Submission, introduction: Introduction) -> list[str]:
    """How the submission's process is started."""
    awaited = json.dumps([introduction.topics, introduction.services])
    return [sys.executable, student_main.__file__, awaited, *stage.target(submission)]


def _watch(
    simulator: Simulator, student: Watched, progress: Progress | None
) -> tuple[Message, int | None]:
    """Start the clock of the run, wait for its end; how it came and the student's exit code."""
    simulator.say("start")
    exit_code: int | None = None
    while True:
        message = simulator.next(0.05)
        if message and message["say"] == "done":
            return message, exit_code
        if message and progress:
            progress(message["seconds"])
        if exit_code is None and (exit_code := student.poll()) is not None:
            simulator.say("exited")
