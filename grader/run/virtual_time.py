"""A graded run in virtual time: a minute in seconds, and the same every time.

The submission's process and the simulator's move in lockstep, linked by a socket of their own; the
grader only starts them and waits. What cannot run so runs in real time, and the result says why.
"""

from __future__ import annotations

import json
import socket
import time
from contextlib import closing
from dataclasses import asdict, replace
from functools import partial

from grader import linux
from grader.errors import GraderFailure, SceneFailure
from grader.message import NOTHING, Message, msg
from grader.recording.recording import Outcome, Recording
from grader.run import fork_servers, handover, real_time, run_context
from grader.run.environment import virtual_environment
from grader.run.evidence import EvidencePage
from grader.run.finish import SimulatorLost, ended, outcome, record
from grader.run.handover import Plan
from grader.run.limits import END_S, SIMULATOR_S, CpuBudget, Patience
from grader.run.processes import cores
from grader.run.real_time import Progress
from grader.run.simulator_process import (
    Audience,
    Simulator,
    SimulatorMessage,
    live_feed,
    start_simulator,
)
from grader.scenes import load_scene
from grader.scenes.scene import Introduction
from grader.submission.start import Launch, Submission

WAITS_FOR_EVER = msg("every thread of the node waits for something that will not come")
STUCK = msg("the node waits for something that can no longer happen")
STOPPED = msg("the node's process was stopped (SIGSTOP), and nobody let it go on")
FLOODING = msg(
    "the node sent so much that the simulator used more than {seconds} s of processor time"
)
#: The silences of a program that still runs, and can be asked to dump where it is.
COMPUTES = ("stalled", "slow")
PATIENCE = Patience()


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
        marks: filled with the times, on the machine's monotonic clock [s], of the first message
            between the two processes (`met`), of their connection by DDS (`connected`), of the last
            tick (`over`).
        audience: receives the run live; changes nothing of what is recorded.

    Raises:
        GraderFailure: the simulator could not be started or died; a `SimulatorLost` where the
            submission had sent it something; a `SceneFailure` where the scene is to blame.
    """
    why = _not_in_virtual_time(submission)
    if not why:
        known = {} if marks is None else marks
        recording, why = _try(submission, plan, patience, known, audience)
        if recording is not None:
            return recording
    flag = msg("graded in real time, because {why}", why=why)
    return real_time.run(submission, replace(plan, flags=(flag, *plan.flags)), progress, audience)


def _not_in_virtual_time(submission: Submission) -> Message:
    """Return why a start does not fit virtual time, for "because ..."; NOTHING where it does."""
    if not isinstance(submission.start, Launch):
        return NOTHING
    names = ", ".join(each.name for each in submission.start.programs)
    return msg("several programs were started, each in a process of its own: {names}", names=names)


def _try(
    submission: Submission,
    plan: Plan,
    patience: Patience,
    marks: dict[str, float],
    audience: Audience | None,
) -> tuple[Recording | None, Message]:
    """Return the recording of a run in virtual time, or None and why there is none."""
    started = time.monotonic()
    scene = load_scene(plan.scene)
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with (
        run_context.open_context(plan.budget) as context,
        cores.reserve_core(ours.fileno()) as core_id,
        closing(EvidencePage()) as account,
        live_feed(audience, plan, "virtual") as feed,
        ours,
        theirs,
    ):
        fds = (ours.fileno(), account.page)
        submission, student = context.start(
            submission,
            lambda private: command(private, scene.introduction, plan, *fds),
            fds,
            virtual_environment({}),
            fork_servers.for_student(submission.root),
        )
        ours.close()
        ending = partial(ended, "virtual", submission, student, context.isolation, started)
        simulator: Simulator | None = None
        try:
            with student.ended_at_exit(gently=False):
                more = (str(student.pid), str(core_id), json.dumps(asdict(patience)))
                server = fork_servers.server(fork_servers.SIMULATOR)
                shared = (theirs.fileno(), account.page)
                with start_simulator(
                    fork_servers.MODULE, context, plan, shared, *more, server=server, feed=feed
                ) as simulator:
                    theirs.close()
                    message = _watch(simulator, student.pid, plan.budget)
                    if message["say"] == "done" and student.ends_for_excess():
                        message["silence"] = "gone"  # for what it has filled just before
                    exit_code = student.wait(END_S) if message.get("silence") == "gone" else None
                    if message.get("silence") in COMPUTES:
                        account.request_dump(student.pid)
                    elif message.get("silence") == "":
                        account.await_last_write(student.pid)  # the run is over
            if student.was_lost:
                raise GraderFailure(
                    msg("the process from which a submission's was forked has died")
                )
            if message["say"] == "refused":
                reason = Message.parse(message["reason"])
                return None, reason.map_texts(submission.with_original_paths)
            marks.update(message["marks"])
            trace, topics = handover.fetch(context.recording, handover.keeper(plan, scene))
        except SceneFailure:
            raise
        except GraderFailure as failure:
            if simulator is None or not simulator.is_driven or student.was_lost:
                raise
            raise SimulatorLost(failure, ending("killed", None)) from failure
    how, flags = _judge(message, exit_code, patience)
    flags += map(Message.parse, message["flags"])
    computes = message["silence"] in COMPUTES
    observations = account.observations(submission, message["reached_s"], computes=computes)
    return record(plan, trace, topics, ending(how, exit_code, tuple(flags)), observations), NOTHING


def command(
    submission: Submission, introduction: Introduction, plan: Plan, link_fd: int, page: int
) -> list[str]:
    """Return the command of the submission's process."""
    own = submission.interfaces
    nodes = [*introduction.nodes, *((name, "/") for name in plan.cast or ())]
    known = json.dumps(
        [
            *(nodes, introduction.compares_stamps, own.texts, list(own.unlike)),
            *(plan.cast is not None, plan.arguments),
        ]
    )
    words = [str(link_fd), str(page), known, *run_context.start_arguments(submission)]
    return [*fork_servers.command(fork_servers.STUDENT), *words]


def _watch(simulator: Simulator, student_pid: int, budget: CpuBudget) -> SimulatorMessage:
    """Wait for the end of the run, for as long as one of its processes does something."""
    used_s, since, spent_s = -1.0, 0.0, linux.process_stat(simulator.pid).cpu_s
    while (message := simulator.next(0.2)) is None or message["say"] == "met":
        simulator.is_driven = simulator.is_driven or message is not None
        simulator_s = linux.process_stat(simulator.pid).cpu_s
        budget.spend(max(0.0, simulator_s - spent_s))
        spent_s = max(spent_s, simulator_s)
        now_used_s = simulator_s + linux.process_stat(student_pid).cpu_s
        if now_used_s != used_s:
            used_s, since = now_used_s, time.monotonic()
        if time.monotonic() > since + SIMULATOR_S:
            raise simulator.failure(msg("did not come to an end"))
    return message


def _judge(
    ending: SimulatorMessage, exit_code: int | None, patience: Patience
) -> tuple[Outcome, list[Message]]:
    """Return the outcome of the run, and remarks on it."""
    silence, waits, at_rest = ending["silence"], ending["waits"], ending["was_at_rest"]
    if exit_code is None and waits:
        flag = WAITS_FOR_EVER if waits == "for ever" else STUCK
        return ("finished" if at_rest else "stalled"), ([] if at_rest else [flag])
    if silence == "stalled":
        used_s = patience.stall_cpu_s
        why = msg(
            "the node used {seconds} s of processor time without waiting for ROS",
            seconds=f"{used_s:.0f}",
        )
        return ("finished" if at_rest else "stalled"), [why]
    if silence == "stopped":
        return ("finished" if at_rest else "stalled"), [STOPPED]
    if silence == "slow":
        used = f"{patience.run_cpu_s:.0f}"
        return "time_limit", [
            msg("the node used more than {seconds} s of processor time", seconds=used)
        ]
    if silence == "flooding":
        return "killed", [FLOODING.given(seconds=f"{patience.simulator_cpu_s:.0f}")]
    if silence == "broken":
        return "killed", []
    return outcome(ending["reason"], exit_code), []
