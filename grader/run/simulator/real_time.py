"""The simulator's process in a run in real time: a scene that the wall clock moves.

    python -m grader.run.simulator.real_time CONTROL FILE PLAN FIRST_NODE_S SHOWN

It exchanges JSON lines with the grader over CONTROL, a socket: it sends `ready`, `progress` about
once a second, and `done` when the recording lies in FILE; it receives `start` when the submission's
process is started, and `exited` when that has ended. PLAN is a `grader.run.handover.Plan`, SHOWN a
`LiveFeed.argument`. The clock of the run starts when the submission has its first node, has ended,
or has had FIRST_NODE_S for it [s]. If the grader goes away, so does the simulator.
"""

from __future__ import annotations

import json
import math
import socket
import sys
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import rclpy
from rclpy.signals import SignalHandlerOptions

from grader.errors import SceneFailure
from grader.run import handover
from grader.run.handover import Plan
from grader.run.simulator.process import (
    FeedWriter,
    make_cast,
    protect_process,
    scene_in_time,
    send_message,
)
from grader.run.simulator.wall import WallWire
from grader.scenes.scene import STEP_NS, Hooks, Reason, expect_reason, load_scene
from grader.text.message import Message, msg
from turtlesim_py.ros import program

#: How often the submission's topics are read from the graph, and progress is reported [ticks].
PROGRESS_TICKS = 63
#: The ticks of a run may take so many times as long as planned, and so much longer [s].
SLOWEST, OVERTIME_S = 2.0, 10.0
OVERTIME = msg("the run was ended: the simulator was kept from ticking at its pace")
#: What every node publishes.
EVENTS = "/parameter_events"
#: The most topics of the graph that are read; each takes a while, in the middle of a run.
MOST_TOPICS = 500


class PublishedTopics:
    """The topics on which the submission publishes, by the graph: often a name is wrong.

    Attributes:
        types: topic -> type.
    """

    def __init__(self, nodes: Sequence[Any]) -> None:
        """Read the graph by the first of our nodes, whose publishers do not count."""
        self.types: dict[str, str] = {}
        self._nodes = nodes

    def update(self) -> None:
        """Add the topics that the graph shows now."""
        first, own = self._nodes[0], Counter[str]()
        for node in self._nodes:
            called = node.get_name(), node.get_namespace()
            own.update(t for t, _ in first.get_publisher_names_and_types_by_node(*called))
        for topic, types in first.get_topic_names_and_types()[:MOST_TOPICS]:
            if first.count_publishers(topic) > own[topic]:
                self.types[topic] = types[0]


class GradedSimulator:
    """Runs a scene, and receives the submission's start and end from the grader."""

    def __init__(
        self, link: socket.socket, file: Path, plan: Plan, first_node_s: float, shown: str
    ) -> None:
        self._link = link
        self._first_node_s = first_node_s
        self._file = file
        self._scene = load_scene(plan.scene)
        self._feed = FeedWriter.of(shown, STEP_NS)
        self._wire = None if plan.cast is None else WallWire()
        self._cast = make_cast(plan, self._wire, are_compiled=True)
        hooks = Hooks(send_news=None if self._feed is None else self._feed.write, cast=self._cast)
        with scene_in_time(plan.scene):
            self._simulation = self._scene.simulate(
                plan.limits, plan.start, hooks, plan.interfaces, plan.setting
            )
        nodes = [] if self._scene.has_cast else [self._simulation.node]
        if self._cast is not None and self._wire is not None:
            nodes += [self._wire.node, *self._cast.nodes]
        self._ours = len(nodes) + len(self._scene.introduction.nodes[1:])
        self._node, self._topics = nodes[0], PublishedTopics(nodes)
        self._names = {node.get_fully_qualified_name() for node in nodes}
        self._limits = plan.limits
        self._flags: list[Message] = []
        self._running = False
        self._end_at_s = math.inf
        self._start_at_s = math.inf
        self._ticks = 0

    def run(self) -> None:
        """Serve until the run is over, then save the recording."""
        self._link.setblocking(False)
        self._send("ready")
        reason: Reason = ""

        def tick() -> bool:
            nonlocal reason
            self._receive()
            if not self._running and self._may_start():
                self._start()
            self._play()
            with scene_in_time(self._scene.name):
                reason = self._simulation.tick()
            expect_reason(self._scene.name, reason)
            if self._running:
                self._report_progress()
                reason = reason or self._overtime()
            return not reason

        program.follow_wall_clock(tick)
        if self._feed is not None:
            self._feed.close()
        self._topics.update()
        with scene_in_time(self._scene.name):
            trace = self._simulation.trace()
            handover.leave(self._file, self._scene, trace, self._topics.types, self._cast)
            more = () if self._cast is None else self._cast.flags
            flags = [f.serialise() for f in (*self._simulation.flags, *more, *self._flags)]
        self._send("done", reason=reason, flags=flags)

    def _start(self) -> None:
        if not self._running:
            self._end_at_s = time.monotonic() + SLOWEST * self._limits.total_s + OVERTIME_S
            if self._wire is not None:
                self._wire.begin()
        self._running = True
        self._simulation.record()

    def _play(self) -> None:
        """Let the cast know what the program has, and act."""
        if self._cast is None or self._wire is None:
            return
        endpoints = self._wire.endpoints(self._names)
        if endpoints is not None:
            self._cast.meet(endpoints)
        if self._running:
            self._wire.ticks = self._simulation.ticks
            self._cast.act()

    def _report_progress(self) -> None:
        self._ticks += 1
        if self._ticks % PROGRESS_TICKS == 1:
            self._topics.update()
            self._send("progress", seconds=round(self._simulation.ticks * STEP_NS / 1e9, 1))

    def _overtime(self) -> Reason:
        """Return the reason to end a run whose ticks come far too late; '' otherwise."""
        if time.monotonic() < self._end_at_s:
            return ""
        self._flags.append(OVERTIME)
        return "time_limit"

    def _may_start(self) -> bool:
        """Whether the submission has a node, or has had the time to make one."""
        if math.isinf(self._start_at_s):
            return False
        # Every node has this publisher, and what it publishes with is made known in order: at the
        # latest when its first command or call comes, this is true. Its name may come later.
        has_node = self._node.count_publishers(EVENTS) > self._ours
        return time.monotonic() > self._start_at_s or has_node

    def _send(self, what: str, **more: str | float | list[str]) -> None:
        self._link.setblocking(True)
        send_message(self._link, what, **more)
        self._link.setblocking(False)

    def _receive(self) -> None:
        try:
            text = self._link.recv(4096)
        except BlockingIOError:
            return
        except ConnectionError:
            text = b""
        if not text:
            raise SystemExit(1)  # the grader is gone: nobody wants the recording any more
        for line in text.splitlines():
            match json.loads(line)["say"]:
                case "start":
                    self._start_at_s = time.monotonic() + self._first_node_s
                case "exited":
                    self._start()
                    self._simulation.submission_gone()


def main(argv: list[str]) -> int:
    """Run one graded simulation; the grader reads the exit code."""
    protect_process()
    link = socket.socket(fileno=int(argv[0]))
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    plan, first_node_s = Plan.from_json(argv[2]), float(argv[3])
    try:
        GradedSimulator(link, Path(argv[1]), plan, first_node_s, argv[4]).run()
    except SceneFailure as failure:
        link.setblocking(True)
        send_message(link, "failed", reason=failure.message.serialise())
    rclpy.shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
