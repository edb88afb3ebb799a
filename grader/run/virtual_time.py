"""A graded run in virtual time: a minute in seconds, and the same every time.

The processes of a submission's programs and the simulator's move in lockstep, each program linked
by a socket of its own; the grader only starts them and waits. What cannot run so runs in real time,
and the result says why.
"""

from __future__ import annotations

import json
import socket
import time
from collections.abc import Sequence
from contextlib import ExitStack, closing
from dataclasses import asdict, replace
from typing import Any, NamedTuple

from grader import linux
from grader.errors import GraderFailure, SceneFailure
from grader.message import NOTHING, Message, msg
from grader.recording.recording import Outcome, Recording
from grader.run import fork_servers, handover, real_time, run_context
from grader.run.environment import virtual_environment
from grader.run.evidence import EvidencePage
from grader.run.finish import Ending, SimulatorLost, ended, outcome, record
from grader.run.handover import Plan
from grader.run.limits import END_S, SIMULATOR_S, CpuBudget, Patience
from grader.run.processes import cores
from grader.run.processes.started_process import SubmissionProcess
from grader.run.real_time import Progress
from grader.run.run_context import RunContext
from grader.run.simulator_process import (
    Audience,
    Simulator,
    SimulatorMessage,
    live_feed,
    start_simulator,
)
from grader.scenes import load_scene
from grader.scenes.scene import Introduction
from grader.submission.start import Launch, Program, Submission

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
    known = {} if marks is None else marks
    recording, why = _try(submission, plan, patience, known, audience)
    if recording is not None:
        return recording
    flag = msg("graded in real time, because {why}", why=why)
    return real_time.run(submission, replace(plan, flags=(flag, *plan.flags)), progress, audience)


class _Running(NamedTuple):
    """A program whose process was started.

    Attributes:
        name: as `ros2 launch` prints it; '' for one that was started alone.
        submission: with its paths in the copy of that process.
        link: the simulator's end.
    """

    name: str
    submission: Submission
    student: SubmissionProcess
    account: EvidencePage
    link: socket.socket


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
    launched = submission.start
    programs = launched.programs if isinstance(launched, Launch) else (None,)
    with ExitStack() as held:
        context = held.enter_context(run_context.open_context(plan.budget))
        core_id = held.enter_context(cores.reserve_core(context.recording))
        feed = held.enter_context(live_feed(audience, plan, "virtual"))
        simulator: Simulator | None = None
        running: list[_Running] = []
        try:
            with ExitStack() as students:
                for number, program in enumerate(programs, 1):
                    first = running[0].student if running else None
                    each = _start(program, number, submission, plan, context, held, first)
                    students.enter_context(each.student.ended_at_exit(gently=False))
                    running.append(each)
                pids = json.dumps([each.student.pid for each in running])
                more = (pids, str(core_id), json.dumps(asdict(patience)))
                server = fork_servers.server(fork_servers.SIMULATOR)
                shared = [fd for e in running for fd in (e.link.fileno(), e.account.page)]
                with start_simulator(
                    fork_servers.MODULE, context, plan, shared, *more, server=server, feed=feed
                ) as simulator:
                    for each in running:
                        each.link.close()
                    message = _watch(simulator, [e.student.pid for e in running], plan.budget)
                    told = message.get("programs", ())  # of a run that was made
                    codes = list(map(_exit_code, running, told))
            if any(each.student.was_lost for each in running):
                raise GraderFailure(
                    msg("the process from which a submission's was forked has died")
                )
            if message["say"] == "refused":
                reason = Message.parse(message["reason"])
                return None, reason.map_texts(running[0].submission.with_original_paths)
            marks.update(message["marks"])
            trace, topics = handover.fetch(context.recording, handover.keeper(plan, scene))
        except SceneFailure:
            raise
        except GraderFailure as failure:
            lost = any(each.student.was_lost for each in running)
            if simulator is None or not simulator.is_driven or lost:
                raise
            killed = _ended(running, running[0], context.isolation, started, "killed", None)
            raise SimulatorLost(failure, killed) from failure
    blamed = _blamed(message, codes)
    program, its, exit_code = message["programs"][blamed], running[blamed], codes[blamed]
    how, flags = _judge({**message, **program}, exit_code, patience)
    flags += map(Message.parse, message["flags"])
    computes = program["silence"] in COMPUTES
    observations = its.account.observations(its.submission, program["reached_s"], computes=computes)
    ending = _ended(running, its, context.isolation, started, how, exit_code, tuple(flags))
    return record(plan, trace, topics, ending, observations), NOTHING


def _start(
    program: Program | None,
    number: int,
    submission: Submission,
    plan: Plan,
    context: RunContext,
    held: ExitStack,
    beside: SubmissionProcess | None,
) -> _Running:
    """Start a program; what it needs is released when the context is left.

    Args:
        program: one of several, with its number, from 1; None where the submission starts one.
        beside: the process of the first.
    """
    name, arguments = "", plan.arguments
    if program is None:
        number = 0
    else:
        name, arguments = f"{program.name}-{number}", program.arguments
        submission = replace(submission, start=program.entry)
    account = held.enter_context(closing(EvidencePage()))
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    held.enter_context(theirs)
    scene = load_scene(plan.scene)
    with ours:
        fds = (ours.fileno(), account.page)
        moved, student = context.start(
            submission,
            lambda private: command(private, scene.introduction, plan, *fds, arguments, number),
            fds,
            virtual_environment({}),
            fork_servers.for_student(submission.root),
            beside=beside,
        )
    return _Running(name, moved, student, account, theirs)


def _exit_code(each: _Running, ended: dict[str, Any]) -> int | None:
    """Return a program's exit code once it is known why it says nothing more; None without one.

    Where it did not end by itself, have it leave its last account.
    """
    if each.student.ends_for_excess():
        ended["silence"] = "gone"  # for what it has filled just before
    if ended["silence"] == "gone":
        return each.student.wait(END_S)
    if ended["silence"] in COMPUTES:
        each.account.request_dump(each.student.pid)
    elif ended["silence"] == "":
        each.account.await_last_write(each.student.pid)  # the run is over
    return None


def _blamed(message: SimulatorMessage, codes: list[int | None]) -> int:
    """Return which program a run's outcome is due to: the first that failed, else the first."""
    programs = message["programs"]
    failed = [
        (ended["reached_s"], number)
        for number, (ended, code) in enumerate(zip(programs, codes, strict=True))
        if code or ended["silence"] not in ("", "gone")
    ]
    return min(failed, default=(0.0, 0))[1]


def _ended(
    running: list[_Running],
    blamed: _Running,
    isolation: str,
    started_s: float,
    how: Outcome,
    exit_code: int | None,
    flags: tuple[Message, ...] = (),
) -> Ending:
    """Return how a run has ended; of several programs each line says whose it is."""
    ending = ended(
        "virtual", blamed.submission, blamed.student, isolation, started_s, how, exit_code, flags
    )
    if len(running) == 1:
        return ending
    texts = [each.submission.with_original_paths(each.student.output()) for each in running]
    lines = [
        f"[{each.name}] {line}"
        for each, text in zip(running, texts, strict=True)
        for line in text.splitlines()
    ]
    return ending._replace(output="".join(f"{line}\n" for line in lines))


def command(
    submission: Submission,
    introduction: Introduction,
    plan: Plan,
    link_fd: int,
    page: int,
    arguments: Sequence[str],
    number: int = 0,
) -> list[str]:
    """Return the command of a program's process.

    Args:
        number: of a program among several, from 1; 0 for one alone.
    """
    own = submission.interfaces
    known = json.dumps(
        [
            *(introduction.compares_stamps, own.texts, list(own.unlike)),
            *(plan.cast is not None, number, arguments),
        ]
    )
    words = [str(link_fd), str(page), known, *run_context.start_arguments(submission)]
    return [*fork_servers.command(fork_servers.STUDENT), *words]


def _watch(simulator: Simulator, students: Sequence[int], budget: CpuBudget) -> SimulatorMessage:
    """Wait for the end of the run, for as long as one of its processes does something."""
    used_s, since, spent_s = -1.0, 0.0, linux.process_stat(simulator.pid).cpu_s
    while (message := simulator.next(0.2)) is None or message["say"] == "met":
        simulator.is_driven = simulator.is_driven or message is not None
        simulator_s = linux.process_stat(simulator.pid).cpu_s
        budget.spend(max(0.0, simulator_s - spent_s))
        spent_s = max(spent_s, simulator_s)
        now_used_s = simulator_s + sum(linux.process_stat(pid).cpu_s for pid in students)
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
