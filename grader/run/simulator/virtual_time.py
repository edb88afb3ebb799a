"""The simulator's process in a run in virtual time: it ticks when the submission's process asks.

    python -m grader.run.simulator.virtual_main FD FILE PLAN LINK PAGE PID CORE PATIENCE SHOWN

The first three and SHOWN as in `grader.run.simulator.real_time`; LINK is the socket to the
submission's process PID, PAGE a descriptor of the page in which that notes the tick that it has
reached, CORE the processor core that both are to share (-1: any), PATIENCE a
`grader.run.limits.Patience` as JSON.

What the submission has sent comes with its request for time; answers and published messages go with
the reply (`grader.run.lockstep.protocol`). What happens in a tick is up to the node, as in real
time.
"""

from __future__ import annotations

import gc
import json
import os
import socket
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import rclpy
from rclpy.signals import SignalHandlerOptions

from grader.errors import SceneFailure
from grader.message import msg
from grader.run import handover
from grader.run.handover import Plan
from grader.run.limits import Patience
from grader.run.lockstep import actions, endpoints, rclpy_clocks, waitsets
from grader.run.lockstep.protocol import EPOCH_NS, TICK_NS, Advance, Interests, Reply, State
from grader.run.processes import cores
from grader.run.simulator.endpoints import SimulatorEndpoints
from grader.run.simulator.foresight import MOST_TICKS, Foresight
from grader.run.simulator.link import Refused, StudentLink
from grader.run.simulator.process import (
    FeedWriter,
    make_cast,
    protect_process,
    scene_in_time,
    send_message,
)
from grader.scenes import load_scene
from grader.scenes.scene import STEP_NS, Hooks, Reason, expect_reason

#: So many new objects are searched for garbage: what a run records stays to its end.
GARBAGE = 100_000
#: The most requests of a run that let no time pass; most runs have none of these.
MOST_VAIN = 100_000
VAIN = msg("its process made more than {number} requests that let no time pass", number=MOST_VAIN)


class Lockstep:
    """Ticks a scene as the student's side asks, to the end of the run."""

    def __init__(
        self,
        link: StudentLink,
        plan: Plan,
        share_core: Callable[[], None],
        on_met: Callable[[], None],
        shown: str = "",
    ) -> None:
        """Set up the scene.

        Args:
            share_core: called once, when the submission's process first asks for time.
            on_met: called once, at the first packet of that process.
        """
        self._link = link
        self._on_met = on_met
        self._share_core = share_core
        self.now_ns = 0
        self._clocks = rclpy_clocks.install(lambda: self.now_ns, lambda: None)
        waitsets.install(waitsets.Waiter(self._clocks.attach))
        self._registry = SimulatorEndpoints(lambda: EPOCH_NS + self.now_ns, link.flag)
        endpoints.install(self._registry)
        actions.install()
        if plan.definitions or plan.own_definitions:
            endpoints.make_importable(plan.definitions)
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        self._scene = load_scene(plan.scene)
        assert STEP_NS == TICK_NS
        self._feed = FeedWriter.of(shown, TICK_NS)
        send = None if self._feed is None else self._feed.write
        self._cast = make_cast(plan, self)
        hooks = Hooks(self._registry.has_unread, send, self._cast)
        with scene_in_time(plan.scene):
            self._simulation = self._scene.simulate(
                plan.limits, plan.start, hooks, plan.interfaces, plan.setting
            )
        self._simulation.record()
        self._foresight = Foresight(self._simulation, self._registry)
        self._tick = self._vain = 0
        self._reason: Reason = ""
        #: when the run was connected, over, ..., on the machine's monotonic clock [s]
        self._marks: dict[str, float] = {}
        self._was_at_rest: bool | None = None  # when the submission stopped responding

    def run(self) -> dict[str, Any]:
        """Tick to the end of the run; return how it ended."""
        self._link.introduce(self._registry.pop_table())
        request = self._next_request()
        self._mark("connected")
        self._share_core()
        while request and not self._reason:
            self._link.note_start()
            self._catch_up(request.reached)
            if request.has_mailed:
                self._receive_mail()
            if self._link.waits:
                self._note_rest()
            before = self._tick
            self._advance(request)
            self._reply(request)
            self._vain += self._tick == before
            if self._vain > MOST_VAIN:
                self._link.break_off(VAIN)
            if not self._reason:
                request = self._next_request()
        if not self._reason:
            self._catch_up(self._link.reached())
            self._note_rest()
            self._receive_mail()
        self._finish_alone()
        self._mark("over")
        if self._feed is not None:
            self._feed.close()
        more = () if self._cast is None else self._cast.flags
        return {
            "reason": self._reason,
            "silence": self._link.silence,
            "waits": self._link.waits,
            "was_at_rest": self._was_at_rest,
            "reached_s": min(self._link.reached(), self._tick) * TICK_NS / 1e9,
            "flags": [f.serialise() for f in (*self._link.flags, *self._simulation.flags, *more)],
            "marks": self._marks,
        }

    # For a cast, see `grader.cast.playing.Wire`

    def tap(self, topic: str, kind: str, message: Any) -> None:
        """Record what the program publishes on a topic with a type."""
        self._registry.tap(topic, kind, message)

    def heard(self) -> list[tuple[str, str, int, bytes]]:
        """Return what was recorded since."""
        heard = self._registry.pop_heard()
        return [(topic, kind, time_ns - EPOCH_NS, data) for topic, kind, time_ns, data in heard]

    def has_unread(self) -> bool:
        """Whether something waits for the peers."""
        return self._registry.has_unread()

    def _mark(self, name: str) -> None:
        self._marks.setdefault(name, time.monotonic())

    def _note_rest(self) -> None:
        """Note, once, whether the work was done when the submission stopped responding."""
        if self._was_at_rest is None:
            self._was_at_rest = self._simulation.is_at_rest

    def save(self, file: Path) -> None:
        """Write the recording where the grader finds it."""
        with scene_in_time(self._scene.name):
            trace = self._simulation.trace()
            handover.leave(file, self._scene, trace, self._registry.published, self._cast)

    def _next_request(self) -> Advance | None:
        """Return the next `Advance`, after handling the packets before it."""
        while (packet := self._link.receive()) is not None:
            if "met" not in self._marks:
                self._mark("met")
                self._on_met()
            match packet:
                case Interests():
                    self._registry.note(packet)
                    if self._cast is not None:
                        self._cast.meet(packet.endpoints)
                    self._foresight.forget()
                case Advance():
                    return packet
        return None

    def _receive_mail(self) -> None:
        for parcels in self._link.mail():
            self._registry.receive(parcels)
        if self._cast is not None:
            self._cast.record()

    def _catch_up(self, reached: int) -> None:
        """Make the forecast ticks that the student's side has used."""
        while self._tick < min(reached, self._foresight.end) and not self._reason:
            self._count_tick()
            with scene_in_time(self._scene.name):
                reason = self._foresight.make_tick(EPOCH_NS + self.now_ns)
            self._reason = expect_reason(self._scene.name, reason)
        self._clocks.set_now(self.now_ns)
        self._foresight.forget()

    def _advance(self, request: Advance) -> None:
        last = min(request.target, self._tick + request.most)
        while self._tick < last and not self._reason:
            self._make_tick()
            # or a late reader, for which the program may keep something
            is_met = self._cast is not None and self._registry.changed
            if self._registry.answered or is_met:
                return

    def _make_tick(self) -> None:
        self._count_tick()
        self._clocks.set_now(self.now_ns)
        if self._cast is not None:
            self._cast.act()
        with scene_in_time(self._scene.name):
            reason = self._simulation.tick(EPOCH_NS + self.now_ns)
        self._reason = expect_reason(self._scene.name, reason)

    def _count_tick(self) -> None:
        if self._feed is not None:
            self._feed.pace()
            self._link.excused_cpu_s = self._feed.cpu_s
        self._tick += 1
        self._registry.tick = self._tick
        self.now_ns = self._tick * TICK_NS

    def _reply(self, request: Advance) -> None:
        state = State.OVER if self._reason else State.RUNNING
        parcels = self._registry.pop_outgoing()
        if self._registry.changed:
            self._link.send(self._registry.pop_table())
        elif state == State.RUNNING:
            with scene_in_time(self._scene.name):
                quiet = MOST_TICKS if self._cast is None else self._cast.quiet_ticks()
                self._foresight.foresee(self._tick, request, quiet)
            parcels += self._foresight.parcels
        self._link.send(Reply(self._tick, state, max(self._tick, self._foresight.end), parcels))

    def _finish_alone(self) -> None:
        """Tick to the end without the submission, which sends nothing more."""
        if self._reason:
            return
        if self._link.silence == "gone":
            self._simulation.submission_gone()
        while not self._reason:
            self._make_tick()


def main(argv: list[str]) -> int:
    """Run one simulation in lockstep; the grader reads the exit code."""
    protect_process()
    control = socket.socket(fileno=int(argv[0]))
    theirs = socket.socket(fileno=int(argv[3]))
    page, student, core = map(int, argv[4:7])
    link = StudentLink(theirs, page, student, Patience(**json.loads(argv[7])))

    def share_core() -> None:
        # for both, from here: a submission's process may not choose its cores
        cores.pin(core, os.getpid(), student)

    plan = Plan.from_json(argv[2])
    try:
        lockstep = Lockstep(link, plan, share_core, lambda: send_message(control, "met"), argv[8])
        gc.freeze()
        gc.set_threshold(GARBAGE)
        ending = lockstep.run()
        lockstep.save(Path(argv[1]))
        send_message(control, "done", **ending)
    except Refused as refusal:
        send_message(control, "refused", reason=refusal.why.serialise())
    except SceneFailure as failure:
        send_message(control, "failed", reason=failure.message.serialise())
    return 0
