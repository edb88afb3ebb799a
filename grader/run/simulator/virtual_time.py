"""The simulator's process in a run in virtual time: it ticks when the submission's process asks.

    python -m grader.run.simulator.virtual_main FD FILE PLAN LINK PID CORE PATIENCE

The first three as in `grader.run.simulator.real_time`; LINK is the socket to the submission's
process PID, CORE the processor core to share with it (-1: any), PATIENCE a
`grader.run.simulator.link.Patience` as JSON.

Before a tick, everything that was announced as sent to us has arrived here; what is answered and
published is announced in turn (`grader.run.lockstep.protocol`). What happens in a tick is the
node's own business, as in real time.
"""

from __future__ import annotations

import gc
import json
import signal
import socket
import time
from pathlib import Path
from typing import Any

import rclpy
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.signals import SignalHandlerOptions

from grader.run import handover
from grader.run.lockstep import actions, endpoints, rclpy_clocks, waitsets
from grader.run.lockstep.protocol import TICK_NS, Advance, Hello, Reply, State
from grader.run.lockstep.times import EPOCH_NS
from grader.run.plan import Plan
from grader.run.processes import cores
from grader.run.processes.parent import die_with_parent
from grader.run.simulator.endpoints import SimulatorEndpoints
from grader.run.simulator.link import Patience, Refused, StudentLink
from grader.run.simulator.published_topics import PublishedTopics
from grader.scenes import load_scene
from grader.scenes.scene import Hooks, Reason

#: How long DDS may take to connect two ends [s].
MATCH_PATIENCE_S = 3.0


class Lockstep:
    """Ticks a scene as its student's side asks, to the end of the run."""

    def __init__(self, link: StudentLink, plan: Plan, shared_core: int) -> None:
        self._link = link
        self._core = shared_core
        self.now_ns = 0
        self._clocks = rclpy_clocks.install(_rclpy, lambda: self.now_ns, lambda: None)
        waitsets.install(_NoWaiting(self._clocks))
        self._registry = SimulatorEndpoints()
        endpoints.install(self._registry, lambda: EPOCH_NS + self.now_ns)
        actions.install()
        rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
        self._scene = load_scene(plan.scene)
        assert self._scene.tick_ns == TICK_NS
        hooks = Hooks(has_unread=self._registry.has_unread, after_serving=self._introduce_changes)
        self._simulation = self._scene.simulate(plan.limits, plan.start, hooks, plan.interfaces)
        self._simulation.record()
        self._topics = PublishedTopics(self._simulation.node)
        self._tick = 0
        self._reason: Reason = ""
        self._request: Advance | None = None
        #: when the run reached which stage, on the machine's monotonic clock [s]
        self._marks: dict[str, float] = {}
        self._was_at_rest: bool | None = None  # when the submission stopped responding

    def run(self) -> dict[str, Any]:
        """To the end; how it came."""
        self._link.send(self._registry.table())
        self._request = self._next_request()
        self._mark("connected")
        cores.pin(self._core)
        while self._request and not self._reason:
            self._link.has_started()
            if self._link.waits:
                self._note_rest()
            self._advance(self._request)
            state = State.OVER if self._reason else State.RUNNING
            self._link.send(Reply(self._tick, state, self._registry.take_sent_counts()))
            if not self._reason:
                self._request = self._next_request()
        self._note_rest()
        self._finish_alone()
        self._mark("over")
        return {
            "reason": self._reason,
            "silence": self._link.silence,
            "waits": self._link.waits,
            "was_at_rest": self._was_at_rest,
            "flags": self._link.flags,
            "marks": self._marks,
        }

    def _mark(self, stage: str) -> None:
        self._marks.setdefault(stage, time.monotonic())

    def _note_rest(self) -> None:
        """Whether the work was done is asked once: when the submission stopped."""
        if self._was_at_rest is None:
            self._was_at_rest = self._simulation.is_at_rest

    def save(self, file: Path) -> None:
        """Write the recording where the grader finds it."""
        handover.leave(file, self._scene, self._simulation.trace(), self._topics.found())

    def _next_request(self) -> Advance | None:
        """The next `Advance`, after all `Hello`s before it."""
        while isinstance(request := self._link.receive(), Hello):
            self._mark("met")
            self._registry.pair_locally()
            self._registry.destroy_pending()
            if not self._introduced(request):
                self._link.flag(f"DDS did not connect everything at tick {self._tick}")
            self._link.send(Hello([]))
        assert request is None or isinstance(request, Advance)
        return request

    def _introduced(self, hello: Hello) -> bool:
        """Wait until DDS knows all that the other side says that it has; False if in vain."""
        deadline = time.monotonic() + MATCH_PATIENCE_S
        if not self._registry.await_matches(hello.matched, deadline):
            return False
        while self._topics.look() < hello.publishers:
            if time.monotonic() > deadline:
                return False
            time.sleep(0.001)
        return True

    def _advance(self, request: Advance) -> None:
        self._collect(request)
        last = min(request.target, self._tick + request.most)
        while self._tick < last and not self._reason:
            self._tick_once()
            if self._registry.answered:
                return

    def _collect(self, request: Advance) -> None:
        for reader in self._registry.await_announced(request.sent):
            self._link.flag(f"announced messages on {reader.channel} did not come")

    def _tick_once(self) -> None:
        self._tick += 1
        self.now_ns = self._tick * TICK_NS
        self._clocks.set_now(self.now_ns)
        self._reason = self._simulation.tick()

    def _introduce_changes(self) -> None:
        """In the middle of a tick: have the other side find our new endpoints, and ours its."""
        if not self._registry.changed:
            return
        if self._request is None:
            self._registry.table()
            self._registry.destroy_pending()
            return
        self._link.send(Reply(self._tick - 1, State.CHANGED, self._registry.take_sent_counts()))
        self._link.send(self._registry.table())
        self._request = self._next_request()

    def _finish_alone(self) -> None:
        """The submission says nothing more; the scene goes on."""
        if self._reason:
            return
        self._request = None
        if not self._link.has_left:
            time.sleep(0.05)  # its last messages were not announced, but may have been sent
        for reader in self._registry.readers:
            reader.drain()
        if self._link.silence == "gone":
            self._simulation.submission_gone()
        while not self._reason:
            self._tick_once()


class _NoWaiting:
    """The simulator's wait sets only look."""

    graph_epoch = 0

    def __init__(self, clocks: rclpy_clocks.RclpyClocks) -> None:
        self.tell_time = clocks.tell

    def look_first(self) -> None:
        self.graph_epoch += 1  # QoS events may come at any time, and cost little when served

    def found_work(self) -> None: ...

    def found_nothing(self) -> None: ...

    def wait_for(self, wait_set: Any, deadline_ns: int) -> None:
        raise AssertionError("the simulator never waits for its node")

    def deadline(self, timeout_ns: int) -> int:
        return 0

    def poke(self, cause: object) -> None: ...


def main(argv: list[str]) -> int:
    """Run one simulation in lockstep; the grader reads the exit code."""
    die_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    control = socket.socket(fileno=int(argv[0]))
    theirs = socket.socket(fileno=int(argv[3]))
    link = StudentLink(theirs, int(argv[4]), Patience(**json.loads(argv[6])))
    lockstep = Lockstep(link, Plan.from_json(argv[2]), int(argv[5]))
    gc.collect()
    gc.freeze()
    try:
        ending = lockstep.run()
        lockstep.save(Path(argv[1]))
        message = {"say": "done", **ending}
    except Refused as refusal:
        message = {"say": "refused", "reason": str(refusal)}
    control.sendall(json.dumps(message).encode() + b"\n")
    return 0
