"""A graded run in virtual time: a minute in seconds, and the same every time.

The submission's process and the simulator's move in lockstep, linked by a socket of their own; the
grader only starts them and waits. What cannot run so runs in real time, and the result says why.
"""

from __future__ import annotations

import json
import socket
import time
from dataclasses import asdict, replace
from functools import partial

from grader import usage
from grader.errors import GraderFailure
from grader.language.phrase import say
from grader.recording.recording import Outcome, Recording
from grader.run import evidence, handover, real_time, stage, zygotes
from grader.run.audience import Audience, seats
from grader.run.budget import Budget
from grader.run.environment import virtual_environment
from grader.run.finish import ended, outcome, record
from grader.run.lost import SimulatorLost
from grader.run.plan import Plan
from grader.run.processes import cores
from grader.run.real_time import Progress
from grader.run.simulator.link import Patience
from grader.run.simulator_process import SIMULATOR_PATIENCE_S, Message, Simulator, start_simulator
from grader.scenes import load_scene
from grader.scenes.scene import Introduction
from grader.submission.opening import Submission

WAITS_FOR_EVER = "every thread of the node waits for something that will not come"
STUCK = "the node waits for something that can no longer happen"
STOPPED = "the node's process was stopped (SIGSTOP), and nobody let it go on"
FLOODING = "the node sent so much that the simulator used more than {:.0f} s of processor time"
#: So long a process that has hung up, or was killed, may take to end on a busy machine [s].
END_S = 20.0
#: Of silences: a program that is still there, and could be asked where it is.
COMPUTES = ("stalled", "slow")
PATIENCE = Patience()
#: What runs as the simulator's process.
MODULE = zygotes.MODULE


def run(
    submission: Submission,
    plan: Plan,
    progress: Progress | None = None,
    patience: Patience = PATIENCE,
    marks: dict[str, float] | None = None,
    audience: Audience | None = None,
) -> Recording:
    """Run a submission once in virtual time, or in real time if it must be.

    Args:
        progress: called now and then with the simulated time [s], if the run takes so long.
        patience: how long the submission's process is waited for, in real seconds.
        marks: told when, on the machine's monotonic clock [s], the two processes first heard of
            each other (`met`), were connected by DDS (`connected`), ticked last (`over`).
        audience: who looks on; changes nothing of what is recorded.

    Raises:
        GraderFailure: the simulator could not be started or died; where the submission had said
            something to it, as a `SimulatorLost`.
    """
    why = stage.not_in_virtual_time(submission)
    if not why:
        known = {} if marks is None else marks
        recording, why = _try(submission, plan, patience, known, audience)
        if recording is not None:
            return recording
    flag = f"graded in real time, because {why}"
    return real_time.run(submission, replace(plan, flags=(flag, *plan.flags)), progress, audience)


def _try(
    submission: Submission,
    plan: Plan,
    patience: Patience,
    marks: dict[str, float],
    audience: Audience | None,
) -> tuple[Recording | None, str]:
    """The recording of a run in virtual time, or why there is none."""
    started = time.monotonic()
    scene = load_scene(plan.scene)
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with (
        stage.open_stage(plan.budget) as place,
        cores.reserve_core(ours.fileno()) as core_id,
        evidence.open_evidence() as told,
        seats(audience, plan, "virtual") as seat,
        ours,
        theirs,
    ):
        fds = (ours.fileno(), told.page)
        submission, student = place.start(
            submission,
            lambda own: command(own, scene.introduction, *fds),
            fds,
            virtual_environment({}),
            zygotes.for_student(submission.root),
        )
        ours.close()
        ending = partial(ended, "virtual", submission, student, place.isolation, started)
        is_driven = False
        try:
            try:
                more = (str(student.pid), str(core_id), json.dumps(asdict(patience)))
                zygote = zygotes.zygote(zygotes.SIMULATOR)
                with start_simulator(
                    MODULE, place, plan, theirs, *more, zygote=zygote, seat=seat
                ) as simulator:
                    theirs.close()
                    seat.taken()
                    try:
                        message = _watch(simulator, student.pid, plan.budget)
                    finally:
                        is_driven = simulator.is_driven
                    if message["say"] == "done" and student.ends_for_excess():
                        message["silence"] = "gone"  # for what it has filled since the last look
                    exit_code = student.wait(END_S) if message.get("silence") == "gone" else None
                    if message.get("silence") in COMPUTES:
                        told.ask(student.pid)
                    elif message.get("silence") == "":
                        told.hear_out(student.pid)  # the run is over, and it says what it knows
            finally:
                student.end(gently=False)
            if student.was_lost:
                raise GraderFailure(
                    say("the process from which a submission's was forked has died")
                )
            if message["say"] == "refused":
                return None, submission.as_handed_in(message["reason"])
            marks.update(message["marks"])
            trace, topics = handover.fetch(place.recording, scene)
        except GraderFailure as failure:
            if not is_driven or student.was_lost:
                raise
            raise SimulatorLost(failure, ending("killed", None)) from failure
    how, flags = _judge(message, exit_code, patience)
    flags += message["flags"]
    computes = message["silence"] in COMPUTES
    conduct = told.conduct(submission, message["reached_s"], computes=computes)
    return record(plan, trace, topics, ending(how, exit_code, tuple(flags)), conduct), ""


def command(
    submission: Submission, introduction: Introduction, link_fd: int, page: int
) -> list[str]:
    """How the submission's process is started."""
    known = json.dumps([introduction.nodes, introduction.compares_stamps])
    words = [str(link_fd), str(page), known, *stage.target(submission)]
    return [*zygotes.command(zygotes.STUDENT), *words]


def _watch(simulator: Simulator, student_pid: int, budget: Budget) -> Message:
    """Wait for the end of the run, for as long as one of its processes does something."""
    used_s, since, spent_s = -1.0, 0.0, usage.look(simulator.pid).cpu_s
    while (message := simulator.next(0.2)) is None or message["say"] == "met":
        simulator.is_driven = simulator.is_driven or message is not None
        simulator_s = usage.look(simulator.pid).cpu_s
        budget.spend(max(0.0, simulator_s - spent_s))
        spent_s = max(spent_s, simulator_s)
        now_used_s = simulator_s + usage.look(student_pid).cpu_s
        if now_used_s != used_s:
            used_s, since = now_used_s, time.monotonic()
        if time.monotonic() > since + SIMULATOR_PATIENCE_S:
            raise simulator.failure(say("did not come to an end"))
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
    if silence == "stopped":
        return ("finished" if at_rest else "stalled"), [STOPPED]
    if silence == "slow":
        return "time_limit", [
            f"the node used more than {patience.run_cpu_s:.0f} s of processor time"
        ]
    if silence == "flooding":
        return "killed", [FLOODING.format(patience.simulator_cpu_s)]
    if silence == "broken":
        return "killed", []
    return outcome(ending["reason"], exit_code), []
