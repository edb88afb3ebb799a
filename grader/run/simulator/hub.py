"""The simulator's process in a run in virtual time: the hub of the submission's programs.

    python -m grader.run.simulator.virtual_main FD FILE PLAN PROGRAMS CORE PATIENCE SHOWN

The first three and SHOWN as in `grader.run.simulator.real_time`; PROGRAMS is a JSON list with, of
each, the socket to its process, the page in which that notes the tick that it has reached, its
process id, its name, the place of the one at whose end it is started (-1: with the run), and how
long after that [s]; CORE the processor core that all are to share, PATIENCE a
`grader.run.limits.Patience` as JSON.

One program runs at a time, in the order in which they were started, until it asks for time
(`grader.run.lockstep.protocol`). What it has sent goes on its way then, and who gets something, or
is told that something has appeared or gone, runs again at that moment. Where nobody can run, time
moves to what comes next: a program's deadline, or the scene's next tick. A program that knows that
nobody else can run before some time passes it alone. What happens in a tick is up to the scene, as
in real time.
"""

from __future__ import annotations

import gc
import json
import os
import socket
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import rclpy
from rclpy.signals import SignalHandlerOptions

from grader.errors import SceneFailure
from grader.run.handover import Plan
from grader.run.limits import Patience
from grader.run.lockstep import actions, endpoints, waitsets
from grader.run.lockstep.matching import Writer
from grader.run.lockstep.protocol import (
    EPOCH_NS,
    NEVER,
    SHIFT,
    TICK_NS,
    Advance,
    Parcels,
    Reply,
    Table,
)
from grader.run.processes import cores
from grader.run.simulator.endpoints import SimulatorEndpoints
from grader.run.simulator.foresight import MOST_TICKS, Foresight
from grader.run.simulator.link import NONSENSE, Refused, StudentLink
from grader.run.simulator.process import SceneRun, protect_process, send_message
from grader.scenes.scene import STEP_NS, Reason, expect_reason
from grader.text.message import msg

#: So many new objects are searched for garbage: what a run records stays to its end.
GARBAGE = 100_000
#: The most requests of a program that let no tick pass; most have none of these.
MOST_VAIN = 100_000
VAIN = msg("its process made more than {number} requests that let no time pass", number=MOST_VAIN)
#: So much may wait for a program [bytes]: what comes then is lost, as from a full queue.
MOST_WAITING = 64_000_000
FULL = msg(
    "a program that did not read lost messages: more than {n} MB waited for it",
    n=MOST_WAITING // 1_000_000,
)


@dataclass(eq=False)
class LinkedProgram:
    """One of the programs.

    Attributes:
        number: from 1, in the order in which they were started.
        request: its last one.
        after: the number of the one at whose end it is started; 0 for none.
        start_ns: when it is started, so long after that; before that it is new.
        since_ns: when its last turn began; until_ns: before this it could pass time alone.
        inbox, news: what it gets at its next turn.
        waiting_bytes: of the former.
        is_awake: whether something has come for which it waits.
        is_gone: whether it says nothing more, or nothing yet: it waits for the end of another.
        vain: how many of its requests let no tick pass.
    """

    number: int
    link: StudentLink
    after: int = 0
    start_ns: int = 0
    is_new: bool = True
    request: Advance = field(init=False)
    since_ns: int = 0
    until_ns: int = 0
    inbox: Parcels = field(default_factory=list)
    news: list[Table] = field(default_factory=list)
    waiting_bytes: int = 0
    is_awake: bool = False
    is_gone: bool = False
    vain: int = 0

    def __post_init__(self) -> None:
        self.request = Advance(self.start_ns, False, 0, 0)
        self.is_gone = self.after > 0

    def start_after(self, now_ns: int) -> None:
        """Have it started so long after this moment."""
        self.after, self.is_gone = 0, False
        self.request = Advance(now_ns + self.start_ns, False, 0, 0)

    def is_due(self, now_ns: int) -> bool:
        """Whether it can run at this moment."""
        return self.request.target_ns <= now_ns or (self.is_awake and not self.is_new)

    def has(self, number: int) -> bool:
        """Whether it has the endpoint of a number."""
        return number >> SHIFT == self.number


class Hub(SceneRun):
    """Ticks a scene and gives its programs their turns, to the end of the run."""

    def __init__(
        self,
        links: Sequence[tuple[StudentLink, int, int]],
        names: Sequence[str],
        plan: Plan,
        share_core: Callable[[], None],
        on_met: Callable[[], None],
        shown: str,
    ) -> None:
        """Set up the scene.

        Args:
            links: those of the programs, each with the number of the one at whose end it is started
                (0: with the run), and how long after that [ns].
            names: theirs, as `ros2 launch` prints them.
            share_core: called once, when a program first asks for time.
            on_met: called once, at the first packet of a program.
        """
        #: the number of the program that was heard last
        self.heard_last = 1
        #: where there are several
        self.names = dict(enumerate(names, 1)) if len(names) > 1 else {}
        self._members = [LinkedProgram(number, *its) for number, its in enumerate(links, 1)]
        self._on_met = on_met
        self._share_core = share_core
        #: the time that all programs have reached, and that of the scene, whole ticks
        self._time_ns = self.now_ns = 0
        self._waiter = waitsets.Waiter(lambda: self.now_ns)
        waitsets.install(self._waiter)
        self._registry = SimulatorEndpoints(lambda: EPOCH_NS + self.now_ns, links[0][0].flag)
        self.tap, self.heard = self._registry.tap, self._registry.pop_heard
        endpoints.install(self._registry)
        actions.install()
        if plan.definitions or plan.own_definitions:
            endpoints.make_importable(plan.definitions)
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        assert STEP_NS == TICK_NS
        super().__init__(plan, shown, self, self._registry.has_unread)
        self._simulation.record()
        self._foresight = Foresight(self._simulation, self._registry)
        self._tick = 0
        self._reason: Reason = ""
        self._has_met = False
        self._was_at_rest: bool | None = None  # when the last program stopped responding

    # The run ----------------------------------------------------------------------------------

    def run(self, file: Path) -> dict[str, Any]:
        """Give turns to the end of the run, and save the recording; return how it ended."""
        self._registry.pop_table()
        for member in self._alive():
            if not member.start_ns:
                self._start(member)
        self._share_core()
        while not self._reason and (alive := self._alive()):
            due = [member for member in alive if member.is_due(self._time_ns)]
            if due:
                for member in due:
                    if not self._reason:
                        self._give_turn(member, is_alone=len(due) == 1)
                continue
            next_ns = min(member.request.target_ns for member in alive)
            if next_ns < self.now_ns + TICK_NS:
                self._time_ns = next_ns
            else:
                self._make_tick()
                self._distribute()
        for member in self._alive():
            member.link.send(Reply(self._time_ns, True, self._tick))
        self._finish_alone()
        if self._feed is not None:
            self._feed.close()
        flags = dict.fromkeys(flag for member in self._members for flag in member.link.flags)
        ending = {
            "reason": self._reason,
            "programs": [
                {
                    "is_new": member.is_new,
                    "silence": member.link.silence,
                    "waits": member.link.waits,
                    "reached_s": min(member.link.reached(), self._tick) * TICK_NS / 1e9,
                }
                for member in self._members
            ],
            "was_at_rest": self._was_at_rest,
            "flags": [flag.serialise() for flag in (*flags, *self._scene_flags())],
        }
        self._save(file, self._registry.published)
        return ending

    def _start(self, member: LinkedProgram) -> None:
        """Let a program run for the first time."""
        member.is_new, member.news, member.is_awake = False, [], False
        known = (*self._registry.own.values(), *self._registry.others.values())
        table = Table(tuple(each.info() for each in known), now_ns=self._time_ns)
        member.link.introduce(table)
        self._hear(member)

    def _alive(self) -> list[LinkedProgram]:
        return [member for member in self._members if not member.is_gone]

    def _finish_alone(self) -> None:
        """Tick to the end without the submission, which sends nothing more."""
        if self._reason:
            return
        if all(member.link.silence == "gone" or member.is_new for member in self._members):
            self._simulation.submission_gone()
        while not self._reason:
            self._make_tick()

    def has_unread(self, node: str) -> bool:
        """Whether something waits for a node of the cast's; see `playing.Wire`."""
        readers = self._registry.readers
        return any(reader.items for reader in readers if reader.node == node)

    # A program's turn -------------------------------------------------------------------------

    def _give_turn(self, member: LinkedProgram, *, is_alone: bool) -> None:
        """Let a program run until it asks for time.

        Args:
            is_alone: nobody else can run at this moment.
        """
        tick = self._tick
        self._distribute()
        if member.is_new:
            self._start(member)
            return
        others = [each for each in self._alive() if each is not member]
        is_alone = is_alone and not any(each.is_due(self._time_ns) for each in others)
        until_ns = min((each.request.target_ns for each in others), default=NEVER)
        member.since_ns = self._time_ns
        member.until_ns = until_ns if is_alone else self._time_ns
        news, member.news = member.news, []
        for table in news:
            member.link.send(table)
        parcels, member.inbox = member.inbox, []
        member.waiting_bytes, member.is_awake = 0, False
        if not news and not any(each.request.listens for each in others):
            quiet = MOST_TICKS if self._cast is None else self._cast.quiet_ticks()
            before = min(quiet, (member.until_ns - 1) // TICK_NS - tick)
            with self._in_time():
                self._foresight.foresee(tick, member.request, before)
            parcels += (p for p in self._foresight.parcels if self._gets(member, p.endpoint))
        foreseen = max(tick, self._foresight.end)
        member.link.note_start()
        reply = Reply(self._time_ns, False, foreseen, member.until_ns, parcels)
        member.link.send(reply)
        self._hear(member)
        member.vain += tick == self._tick
        if member.vain > MOST_VAIN and not member.is_gone:
            member.link.break_off(VAIN)
            self._lose(member)

    def _hear(self, member: LinkedProgram) -> None:
        """Handle what a program says, until it asks for time or says nothing more."""
        self.heard_last = member.number
        while (packet := member.link.receive()) is not None:
            if not self._has_met:
                self._has_met = True
                self._on_met()
            if isinstance(packet, Advance):
                member.request = packet
                self._catch_up(packet.reached, member)
                own_ns = min(packet.now_ns, member.until_ns - 1, self.now_ns + TICK_NS - 1)
                self._time_ns = max(self._time_ns, own_ns)
                if packet.has_mailed:
                    self._receive_mail(member)
                if all(each.is_gone or each.link.waits for each in self._members):
                    self._note_rest()
                return
            try:
                self._note(member, packet)
            except ValueError:
                member.link.break_off(NONSENSE)
        self._lose(member)

    def _lose(self, member: LinkedProgram) -> None:
        """Note that a program says nothing more; what it has sent before counts."""
        member.is_gone = True
        self._catch_up(member.link.reached(), member)
        for each in self._members:
            if each.after == member.number and member.link.silence == "gone":
                each.start_after(self._time_ns)
        if not self._alive():
            self._note_rest()
        self._receive_mail(member)
        if self._alive() and member.link.silence == "gone":
            gone = [number for number in self._registry.others if member.has(number)]
            self._note(member, Table((), tuple(gone)))

    def _note_rest(self) -> None:
        """Note, once, whether the work was done when the submission stopped responding."""
        if self._was_at_rest is None:
            self._was_at_rest = self._simulation.is_at_rest

    # Who is there -----------------------------------------------------------------------------

    def _note(self, member: LinkedProgram, table: Table) -> None:
        """Note what a program has, and has no more."""
        self._registry.note(table, member.number)
        if self._cast is not None:
            self._cast.meet(self._registry.theirs)
        self._foresight.forget()
        for each in self._alive():
            if each is not member:
                each.news.append(table)
                each.is_awake = True

    # Messages ---------------------------------------------------------------------------------

    def _receive_mail(self, member: LinkedProgram) -> None:
        """Pass on what a program has sent."""
        for parcels in member.link.mail():
            ours = [p for p in parcels if p.endpoint >> SHIFT == 0]
            self._registry.receive(ours, member.number, member.since_ns, self._time_ns)
            others = [p for p in parcels if p.endpoint >> SHIFT]
            for each in self._alive():
                before = len(each.inbox)
                self._put(each, others)
                if len(each.inbox) > before:  # what it has waited for may have come
                    each.link.waits = ""
        if self._cast is not None:
            self._cast.record()

    def _distribute(self) -> None:
        """Pass on what the scene and the cast have sent since, and what they have now."""
        is_answered = self._registry.answered
        parcels = self._registry.pop_outgoing()
        table = self._registry.pop_table() if self._registry.changed else None
        for each in self._alive():
            if table is not None:
                each.news.append(table)
                each.is_awake = True
            self._put(each, parcels, wakes=is_answered or each.request.listens)

    def _put(self, member: LinkedProgram, parcels: Parcels, *, wakes: bool = True) -> None:
        """Add what a program gets of these messages to its inbox, as far as there is room."""
        for parcel in parcels:
            if not self._gets(member, parcel.endpoint):
                continue
            member.waiting_bytes += len(parcel.data)
            if member.waiting_bytes > MOST_WAITING:
                self._members[0].link.flag(FULL)
                return
            member.is_awake |= wakes
            member.inbox.append(parcel._replace(time_ns=min(parcel.time_ns, self._time_ns)))

    def _gets(self, member: LinkedProgram, number: int) -> bool:
        """Whether a reader is a program's, or it hears a writer of the simulator's."""
        if number >> SHIFT:
            return member.has(number)
        writer = self._registry.own.get(number)
        if not isinstance(writer, Writer):  # it has just gone
            return True
        return writer.is_lasting or any(member.has(each.number) for each in writer.remote)

    # Time -------------------------------------------------------------------------------------

    def _catch_up(self, reached: int, member: LinkedProgram) -> None:
        """Make the forecast ticks that a program has used."""
        with self._in_time():  # a second's ticks at most
            while self._tick < min(reached, self._foresight.end) and not self._reason:
                self._count_tick()
                reason = self._foresight.make_tick(EPOCH_NS + self.now_ns)
                self._reason = expect_reason(self._scene.name, reason)
        self._waiter.set_now(self.now_ns)
        used = [p for p in self._foresight.parcels if p.time_ns <= self.now_ns]
        self._foresight.forget()
        for each in self._alive():
            if each is not member:
                self._put(each, used, wakes=False)

    def _make_tick(self) -> None:
        self._count_tick()
        self._waiter.set_now(self.now_ns)
        if self._cast is not None:
            self._cast.act()
        self._reason = self._tick_scene(EPOCH_NS + self.now_ns)

    def _count_tick(self) -> None:
        if self._feed is not None:
            self._feed.pace()
            for member in self._members:
                member.link.excused_cpu_s = self._feed.cpu_s
        self._tick += 1
        self.now_ns = self._time_ns = self._tick * TICK_NS


def main(argv: list[str]) -> int:
    """Run one simulation in lockstep; the grader reads the exit code."""
    protect_process()
    control = socket.socket(fileno=int(argv[0]))
    programs, core, patience = map(json.loads, argv[3:6])
    students, names = [pid for _, _, pid, *_ in programs], [each[3] for each in programs]
    links = []
    for link, page, pid, _, after, delay_s in programs:
        its = (socket.socket(fileno=link), page, pid, Patience(**patience), {*students} - {pid})
        links.append((StudentLink(*its), after + 1, round(delay_s * 1e9)))

    def share_core() -> None:
        # for all, from here: a submission's process may not choose its cores
        cores.pin(core, os.getpid(), *students)

    plan = Plan.from_json(argv[2])
    try:
        hub = Hub(links, names, plan, share_core, lambda: send_message(control, "met"), argv[6])
        gc.freeze()
        gc.set_threshold(GARBAGE)
        send_message(control, "done", **hub.run(Path(argv[1])))
    except Refused as refusal:
        why = refusal.why.serialise()
        send_message(control, "refused", reason=why, program=hub.heard_last - 1)
    except SceneFailure as failure:
        send_message(control, "failed", reason=failure.message.serialise())
    return 0
