"""A graded run in virtual time: a minute in seconds, and the same every time.

The submission's process and the simulator's move in lockstep, linked by a socket of their own; the
grader only starts them and waits. What cannot run so runs in real time, and the result says why.
"""

from __future__ import annotations

import json
import socket
import sys
import time
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path

from grader.exercise.loading import Limits
from grader.recording.recording import Outcome, Recording, Start
from grader.run import real_time, stage
from grader.run.processes import cores
from grader.run.simulator.link import Patience
from grader.run.simulator_process import SIMULATOR_PATIENCE_S, Message, Simulator, start_simulator
from grader.run.student import __path__ as student_folder
from grader.submission.opening import Submission

WAITS_FOR_EVER = "every thread of the node waits for something that will not come"
STUCK = "the node waits for something that can no longer happen; its output says where"
PATIENCE = Patience()


def run(
    submission: Submission,
    limits: Limits,
    start: Start | None = None,
    progress: Callable[[float], None] | None = None,
    patience: Patience = PATIENCE,
    marks: dict[str, float] | None = None,
) -> Recording:
    """Run a submission once in virtual time, or in real time if it must be.

    Args:
        start: where turtle1 stands at first; None for its usual place.
        progress: called now and then with the simulated time [s], if the run takes so long.
        patience: how long the submission's process is waited for, in real seconds.
        marks: told when, on the machine's monotonic clock [s], the two processes first heard of
            each other (`met`), were connected by DDS (`connected`), ticked last (`over`).

    Raises:
        GraderFailure: the simulator could not be started or died.
    """
    recording, why = _try(submission, limits, start, patience, {} if marks is None else marks)
    if recording is not None:
        return recording
    recording = real_time.run(submission, limits, start, progress)
    flag = f"graded in real time, because the submission {why}"
    return replace(recording, run=replace(recording.run, flags=(*recording.run.flags, flag)))


def _try(
    submission: Submission,
    limits: Limits,
    start: Start | None,
    patience: Patience,
    marks: dict[str, float],
) -> tuple[Recording | None, str]:
    """The recording of a run in virtual time, or why there is none."""
    started = time.monotonic()
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with stage.open_stage() as place, cores.reserve_core(ours.fileno()) as core_id, ours, theirs:
        student = place.student(
            command(submission, ours.fileno(), core_id),
            submission,
            pass_fds=(ours.fileno(),),
            more_env={"PYTHONHASHSEED": "0"},
        )
        ours.close()
        try:
            more = (str(student.pid), str(core_id), json.dumps(asdict(patience)))
            module = "grader.run.simulator.virtual_time"
            with start_simulator(module, place, limits, start, theirs, *more) as simulator:
                theirs.close()
                ending = _watch(simulator, patience.run_s)
                exit_code = student.wait(2.0) if ending.get("silence") == "gone" else None
        finally:
            student.end(gently=False)
        if ending["say"] == "refused":
            return None, ending["reason"]
        marks.update(ending["marks"])
        recording = stage.fetch(place, start, student.output())
    outcome, flags = _judge(ending, exit_code, patience)
    return recording.finished(
        time="virtual",
        outcome=outcome,
        exit_code=exit_code,
        wall_s=round(time.monotonic() - started, 3),
        isolation=place.isolation,
        flags=(*flags, *ending["flags"]),
    ), ""


def command(submission: Submission, link_fd: int, core_id: int) -> list[str]:
    """How the submission's process is started."""
    main = str(Path(student_folder[0]) / "virtual_main.py")
    return [sys.executable, main, str(link_fd), str(core_id), *stage.target(submission)]


def _watch(simulator: Simulator, run_s: float) -> Message:
    """Wait for the end of the run."""
    deadline = time.monotonic() + run_s + SIMULATOR_PATIENCE_S
    while (message := simulator.next(0.2)) is None:
        if time.monotonic() > deadline:
            raise simulator.failure("did not come to an end")
    return message


def _judge(ending: Message, exit_code: int | None, patience: Patience) -> tuple[Outcome, list[str]]:
    """How the run ended, and remarks on that."""
    silence, waits, at_rest = ending["silence"], ending["waits"], ending["was_at_rest"]
    if exit_code is None and waits:
        flag = WAITS_FOR_EVER if waits == "for ever" else STUCK
        return ("finished" if at_rest else "stalled"), ([] if at_rest else [flag])
    if silence == "stalled":
        used_s = patience.stall_cpu_s
        why = f"the node used {used_s:.0f} s of processor time without waiting for ROS"
        return ("finished" if at_rest else "stalled"), [why]
    if silence == "slow":
        return "time_limit", [f"the run took more than {patience.run_s:.0f} s"]
    if silence == "broken":
        return "killed", []
    return stage.outcome(ending["reason"], exit_code), []
