"""A graded run in real time: the wall clock moves the turtle while the submission drives it."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

from grader.exercise.loading import Limits
from grader.recording.recording import Recording, Start
from grader.run import stage
from grader.run.processes.watched import Student
from grader.run.simulator_process import Simulator, start_simulator
from grader.run.student import main as student_main
from grader.submission.opening import Submission

#: What runs as the simulator's process.
MODULE = "grader.run.simulator.real_time"


def run(
    submission: Submission,
    limits: Limits,
    start: Start | None = None,
    progress: Callable[[float], None] | None = None,
) -> Recording:
    """Run a submission once beside a simulator of its own.

    Args:
        start: where turtle1 stands at first; None for its usual place.
        progress: called about once a second with the simulated time [s].

    Raises:
        GraderFailure: the simulator could not be started or died.
    """
    started = time.monotonic()
    with stage.open_stage() as place:
        with start_simulator(MODULE, place, limits, start) as simulator:
            simulator.expect("ready")
            student = place.student(command(submission), submission)
            try:
                reason, exit_code = _watch(simulator, student, progress)
            finally:
                student.end()
        recording = stage.fetch(place, start, student.output())
    return recording.finished(
        time="real",
        outcome=stage.outcome(reason, exit_code),
        exit_code=exit_code,
        wall_s=round(time.monotonic() - started, 3),
        isolation=place.isolation,
    )


def command(submission: Submission) -> list[str]:
    """How the submission's process is started."""
    return [sys.executable, student_main.__file__, *stage.target(submission)]


def _watch(
    simulator: Simulator, student: Student, progress: Callable[[float], None] | None
) -> tuple[str, int | None]:
    """Start the clock of the run, wait for its end; the reason and the student's exit code."""
    simulator.say("start")
    exit_code: int | None = None
    while True:
        message = simulator.next(0.05)
        if message and message["say"] == "done":
            return message["reason"], exit_code
        if message and progress:
            progress(message["seconds"])
        if exit_code is None and (exit_code := student.poll()) is not None:
            simulator.say("exited")
