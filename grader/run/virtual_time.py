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
from functools import partial
from itertools import chain
from typing import Any

from grader.errors import GraderFailure, SceneFailure
from grader.recording.recording import Outcome, Recording
from grader.run import fork_servers, handover, real_time, run_context
from grader.run.environment import virtual_environment
from grader.run.evidence import EvidencePage
from grader.run.finish import (
    ProgramEnd,
    RunningProgram,
    SimulatorLost,
    blamed,
    ending_of,
    observations_of,
    outcome,
    record,
)
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
from grader.scenes.scene import Introduction, load_scene
from grader.submission.program import Program
from grader.submission.start import Submission
from grader.system import linux
from grader.text.message import NOTHING, Message, msg

WAITS_FOR_EVER = msg("every thread of the node waits for something that will not come")
STUCK = msg("the node waits for something that can no longer happen")
STOPPED = msg("the node's process was stopped (SIGSTOP), and nobody let it go on")
STALLED = msg("the node used {seconds} s of processor time without waiting for ROS")
SLOW = msg("the node used more than {seconds} s of processor time")
FLOODING = msg(
    "the node sent so much that the simulator used more than {seconds} s of processor time"
)
ENDED = msg("{program} ended by itself at {at:.1f} s")
OF_PROGRAM = msg("{program}: {flag}")
TOO_LATE = msg("{program} was to start at {at:g} s, when the run was over")
NEVER_ENDED = msg("{program} was to start at the end of {other}, which did not come")
#: The silences of a program that still runs, and can be asked to dump where it is.
COMPUTES = ("stalled", "slow")
PATIENCE = Patience()


def run(
    submission: Submission,
    plan: Plan,
    progress: Progress | None = None,
    patience: Patience = PATIENCE,
    audience: Audience | None = None,
) -> Recording:
    """Run a submission once in virtual time, or in real time if it must be.

    Args:
        progress: called now and then with the simulated time [s], if the run takes so long.
        patience: how long the submission's process is waited for, in real seconds.
        audience: receives the run live; changes nothing of what is recorded.
    """
    recording, why = _try(submission, plan, patience, audience)
    if recording is not None:
        return recording
    flag = msg("graded in real time, because {why}", why=why)
    return real_time.run(submission, replace(plan, flags=(flag, *plan.flags)), progress, audience)


def _try(
    submission: Submission,
    plan: Plan,
    patience: Patience,
    audience: Audience | None,
) -> tuple[Recording | None, Message]:
    """Return the recording of a run in virtual time, or None and why there is none."""
    started = time.monotonic()
    scene = load_scene(plan.scene)
    with ExitStack() as held:
        context = held.enter_context(run_context.open_context(plan.budget))
        core_id = held.enter_context(cores.reserve_core(context.recording))
        feed = held.enter_context(live_feed(audience, plan, "virtual"))
        simulator: Simulator | None = None
        running: list[RunningProgram] = []
        links: list[socket.socket] = []
        try:
            with ExitStack() as students:
                programs = submission.programs
                first_number = 1 if len(programs) > 1 or programs[0].delay_s else 0
                for number, program in enumerate(programs, first_number):
                    first = running[0].process if running else None
                    its, link = _start(program, number, submission, plan, context, held, first)
                    students.enter_context(its.process.ended_at_exit(gently=False))
                    running.append(its)
                    links.append(link)
                starts = [
                    (link.fileno(), its.account.page, its.process.pid, p.name, p.after, p.delay_s)
                    for link, its, p in zip(links, running, programs, strict=True)
                ]
                shared = [fd for link_fd, page, *_ in starts for fd in (link_fd, page)]
                more = map(json.dumps, (starts, core_id, asdict(patience)))
                server = fork_servers.server(fork_servers.SIMULATOR)
                with start_simulator(
                    fork_servers.MODULE, context, plan, shared, *more, server=server, feed=feed
                ) as simulator:
                    for link in links:
                        link.close()
                    message = _watch(simulator, [e.process.pid for e in running], plan.budget)
                    told = message.get("programs", ())  # of a run that was made
                    codes = list(map(_exit_code, running, told))
            if any(each.process.was_lost for each in running):
                raise GraderFailure(
                    msg("the process from which a submission's was forked has died")
                )
            if message["say"] == "refused":
                its, reason = running[message.get("program", 0)], Message.parse(message["reason"])
                reason = reason.map_texts(its.submission.with_original_paths)
                if len(running) > 1:
                    reason = msg("{why} ({program})", why=reason, program=its.program.name)
                return None, reason
            recorded = handover.fetch(context.recording, handover.keeper(plan, scene))
        except SceneFailure:
            raise
        except GraderFailure as failure:
            is_ours = any(each.process.was_lost for each in running)
            if simulator is None or not simulator.is_driven or is_ours:
                raise
            what_ran = (running, context.isolation, started)
            raise SimulatorLost(failure, "virtual", *what_ran) from failure
        how_each_ended = [
            (its, _end_of(its.program, programs, message | told, code, patience))
            for its, told, code in zip(running, message["programs"], codes, strict=True)
            if not (told["is_new"] and its.program.is_respawned(programs))
        ]
        running, ends = map(list, zip(*how_each_ended, strict=True))
        late = [*chain(*(end.remarks for end in ends if end.outcome == "not_run"))]
        late += [
            ENDED.given(program=its.program.name, at=end.at_s)
            for its, end in how_each_ended
            if end.exit_code == 0 and any(each.exit_code is None for each in ends)
        ]
        its, end = how_each_ended[blamed(ends)]
        own = end.remarks if end.outcome != "not_run" else ()
        if len(running) > 1:
            own = [OF_PROGRAM.given(program=its.program.name, flag=flag) for flag in own]
        flags = (*own, *late, *map(Message.parse, message["flags"]))
        ending = ending_of("virtual", running, ends, context.isolation, started, flags)
        return record(plan, *recorded, ending, observations_of(running, ends)), NOTHING


def _start(
    program: Program,
    number: int,
    submission: Submission,
    plan: Plan,
    context: RunContext,
    held: ExitStack,
    beside: SubmissionProcess | None,
) -> tuple[RunningProgram, socket.socket]:
    """Start a program beside the first; return it, and the simulator's end of its link.

    Args:
        number: of several, from 1; 0 for one alone, which need not wait for its turn.
    """
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    held.enter_context(theirs)
    account = held.enter_context(closing(EvidencePage()))
    introduction = load_scene(plan.scene).introduction
    with ours:
        fds = (ours.fileno(), account.page)
        moved, process = context.start(
            submission.alone(program),
            partial(command, introduction, plan, number, *fds),
            fds,
            virtual_environment({}),
            fork_servers.for_student(program.root),
            beside=beside,
        )
    return RunningProgram(program, moved, process, account), theirs


def _exit_code(each: RunningProgram, ended: dict[str, Any]) -> int | None:
    """Return a program's exit code once it is known why it says nothing more; None without one.

    Where it did not end by itself, have it leave its last account.
    """
    if ended["is_new"]:
        return None
    if each.process.ends_for_excess():
        ended["silence"] = "gone"  # for what it has filled just before
    if ended["silence"] == "gone":
        return each.process.wait(END_S)
    if ended["silence"] in COMPUTES:
        each.account.request_dump(each.process.pid)
    elif ended["silence"] == "":
        each.account.await_last_write(each.process.pid)  # the run is over
    return None


def command(
    introduction: Introduction,
    plan: Plan,
    number: int,
    link: int,
    page: int,
    submission: Submission,
) -> list[str]:
    """Return the command of a program's process; `link`, `page`: descriptors."""
    own, is_recorded = submission.interfaces, plan.cast is not None
    known = [introduction.compares_stamps, own.texts, list(own.unlike), is_recorded, number]
    start = run_context.start_of(submission, plan.arguments)
    words = [str(link), str(page), json.dumps(known), start]
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


def _end_of(
    program: Program,
    beside: Sequence[Program],
    ending: SimulatorMessage,
    exit_code: int | None,
    patience: Patience,
) -> ProgramEnd:
    """Return how a program has ended, with remarks on it."""
    how: Outcome
    if not ending["is_new"]:
        how, remarks = _judge(ending, exit_code, patience)
    elif program.after < 0:
        how, remarks = "not_run", [TOO_LATE.given(program=program.name, at=program.delay_s)]
    else:
        other = beside[program.after].name
        how, remarks = "not_run", [NEVER_ENDED.given(program=program.name, other=other)]
    has_failed = bool(exit_code) or ending["silence"] not in ("", "gone")
    computes = ending["silence"] in COMPUTES
    return ProgramEnd(how, exit_code, ending["reached_s"], has_failed, computes, remarks)


def _judge(
    ending: SimulatorMessage, exit_code: int | None, patience: Patience
) -> tuple[Outcome, list[Message]]:
    """Return the outcome of the run, and remarks on it."""
    silence, waits, at_rest = ending["silence"], ending["waits"], ending["was_at_rest"]
    if exit_code is None and waits:
        # of several, one may well wait while others go on: nobody asks whether it is at rest
        is_done = at_rest or (at_rest is None and waits == "for ever")
        flag = WAITS_FOR_EVER if waits == "for ever" else STUCK
        return ("finished" if is_done else "stalled"), ([] if is_done else [flag])
    if silence in ("stalled", "stopped"):
        why = STALLED.given(seconds=f"{patience.stall_cpu_s:.0f}")
        flag = why if silence == "stalled" else STOPPED
        return ("finished" if at_rest else "stalled"), [flag]
    if silence == "slow":
        return "time_limit", [SLOW.given(seconds=f"{patience.run_cpu_s:.0f}")]
    if silence == "flooding":
        return "killed", [FLOODING.given(seconds=f"{patience.simulator_cpu_s:.0f}")]
    if silence == "broken":
        return "killed", []
    return outcome(ending["reason"], exit_code), []
