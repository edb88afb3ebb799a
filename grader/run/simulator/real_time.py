"""The simulator's process in a run in real time: a scene that the wall clock moves.

    python -m grader.run.simulator.real_time CONTROL FILE PLAN FIRST_NODE_S SHOWN

It exchanges JSON lines with the grader over CONTROL, a socket: it sends `ready`, `progress` about
once a second, and `done` when the recording lies in FILE; it receives `start` when the submission's
process is started, and `exited` when that has ended. PLAN is a `grader.run.handover.Plan`, SHOWN a
`LiveFeed` argument. The clock of the run starts when the submission has its first node, has ended,
or has had FIRST_NODE_S for it [s]. If the grader goes away, so does the simulator.
"""

from __future__ import annotations

import json
import math
import socket
import sys
import time
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import rclpy
from rclpy.context import Context
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node
from rclpy.qos import QoSDurabilityPolicy, QoSProfile, QoSReliabilityPolicy
from rclpy.signals import SignalHandlerOptions

from grader.errors import SceneFailure
from grader.run.handover import Plan
from grader.run.lockstep.protocol import EndpointInfo
from grader.run.simulator.process import SceneRun, protect_process, send_message
from grader.scenes.scene import STEP_NS, Reason
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
MOST_TOPICS: Final = 500
#: The node that records what a cast hears, and how often it reads the graph [ticks].
RECORDER: Final = "recorder"
EVERY_TICKS: Final = 5
#: A message may reach another before us, which has logged that when we get it [ns].
LATE_NS: Final = 500_000_000


class GradedSimulator(SceneRun):
    """Runs a scene, and receives the submission's start and end from the grader."""

    def __init__(
        self, link: socket.socket, file: Path, plan: Plan, first_node_s: float, shown: str
    ) -> None:
        self._link = link
        self._first_node_s = first_node_s
        self._file = file
        self._wire = None if plan.cast is None else WallWire()
        super().__init__(plan, shown, self._wire, are_compiled=True)
        nodes = [] if self._scene.has_cast else [self._simulation.node]
        if self._cast is not None and self._wire is not None:
            nodes += [self._wire.node, *self._cast.nodes]
        self._ours = len(nodes) + len(self._scene.introduction.nodes[1:])
        self._nodes, self._node = nodes, nodes[0]
        self._published: dict[str, str] = {}
        self._names = {node.get_fully_qualified_name() for node in nodes}
        self._limits = plan.limits
        self._flags: list[Message] = []
        self._running = False
        self._end_at_s = math.inf
        self._start_at_s = math.inf
        self._ticks = 0

    def run(self) -> None:
        """Serve until the run is over, then save the recording."""
        send_message(self._link, "ready")
        reason: Reason = ""

        def tick() -> bool:
            nonlocal reason
            self._receive()
            if not self._running and self._may_start():
                self._start()
            self._play()
            reason = self._tick_scene()
            if self._running:
                self._report_progress()
                reason = reason or self._overtime()
            return not reason

        program.follow_wall_clock(tick)
        if self._feed is not None:
            self._feed.close()
        self._note_topics()
        self._save(self._file, self._published)
        flags = [flag.serialise() for flag in (*self._scene_flags(), *self._flags)]
        send_message(self._link, "done", reason=reason, flags=flags)

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
            self._note_topics()
            seconds = round(self._simulation.ticks * STEP_NS / 1e9, 1)
            send_message(self._link, "progress", seconds=seconds)

    def _note_topics(self) -> None:
        """Note on which topics the submission publishes, by the graph: often a name is wrong."""
        own = Counter[str]()
        for node in self._nodes:
            called = node.get_name(), node.get_namespace()
            own.update(t for t, _ in self._node.get_publisher_names_and_types_by_node(*called))
        for topic, types in self._node.get_topic_names_and_types()[:MOST_TOPICS]:
            if self._node.count_publishers(topic) > own[topic]:
                self._published[topic] = types[0]

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

    def _receive(self) -> None:
        try:
            text = self._link.recv(4096, socket.MSG_DONTWAIT)
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


# For a cast -----------------------------------------------------------------------------------


class WallWire:
    """What a cast needs of a run: DDS carries what it hears, and the graph names it.

    See `grader.scenes.cast.playing.Wire`. What records is a subscription, which counts as one: the
    program's graph shows its node.

    Attributes:
        node: that reads the graph, and records.
        ticks: of the run up to now.
        names: not known: DDS does not tell programs apart.
    """

    def __init__(self) -> None:
        self.node = _node(RECORDER, None)
        self.ticks = self._looks = 0
        self.names: dict[int, str] = {}
        self._began_ns = time.time_ns()
        self._heard_ns = 0
        self._served = set[str]()  # in this tick
        #: DDS has one type a topic for each process, unless it takes part several times
        self._others: list[Node] = []
        self._taps: list[tuple[str, str, Any]] = []

    def begin(self) -> None:
        """Note that the clock of the run starts now."""
        self._began_ns = time.time_ns()

    @property
    def now_ns(self) -> int:
        """The time from the start of the run [ns]."""
        return self.ticks * STEP_NS

    def tap(self, topic: str, kind: str, message: Any) -> None:
        """Record what the program publishes on a topic with a type, as well as it is offered."""
        offers = [each.qos_profile for each in self.node.get_publishers_info_by_topic(topic)]
        qos = QoSProfile(depth=1000)  # reliable and volatile
        if any(each.reliability != QoSReliabilityPolicy.RELIABLE for each in offers):
            qos.reliability = QoSReliabilityPolicy.BEST_EFFORT
        lasting = QoSDurabilityPolicy.TRANSIENT_LOCAL
        if all(each.durability == lasting for each in offers):
            qos.durability = lasting
        try:
            made = self.node.create_subscription(message, topic, print, qos, raw=True)
        except rclpy_implementation.RCLError:  # a peer has another type there
            context = Context()
            rclpy.init(args=[], context=context)
            self._others.append(_node(f"{RECORDER}_{len(self._others)}", context))
            made = self._others[-1].create_subscription(message, topic, print, qos, raw=True)
        self._taps.append((topic, kind, made))

    def heard(self) -> Iterator[tuple[str, str, int, bytes, int]]:
        now_ns = self.now_ns
        for topic, kind, tap in self._taps:
            while (found := tap.handle.take_message(tap.msg_type, True)) is not None:
                data, facts = found
                sent_ns = facts["source_timestamp"] - self._began_ns
                at_ns = min(max(sent_ns, self._heard_ns - LATE_NS, 0), now_ns)
                yield topic, kind, at_ns, bytes(data), 0
        self._heard_ns = now_ns

    def has_unread(self, node: str) -> bool:
        """Whether something may wait for a peer's node: once in a tick."""
        is_new = node not in self._served
        self._served.add(node)
        return is_new

    def endpoints(self, ours: set[str]) -> tuple[EndpointInfo, ...] | None:
        """Return what the program has; None in ticks in which nobody looks.

        Args:
            ours: names of nodes that are not the program's.
        """
        self._served.clear()
        self._looks += 1
        if self._looks % EVERY_TICKS:
            return None
        ours = ours | {each.get_fully_qualified_name() for each in (self.node, *self._others)}
        return tuple(sorted({each for each in self._graph() if each.node not in ours}))

    def _graph(self) -> Iterator[EndpointInfo]:
        node = self.node
        for topic, _ in node.get_topic_names_and_types()[:MOST_TOPICS]:
            writers = node.get_publishers_info_by_topic(topic)
            for each in (*writers, *node.get_subscriptions_info_by_topic(topic)):
                qos, name = each.qos_profile, _joined(each.node_namespace, each.node_name)
                policies = (int(qos.reliability), int(qos.durability), max(0, qos.depth))
                writes = any(each is writer for writer in writers)
                kind = each.topic_type
                yield EndpointInfo(name, f"topic {topic}", kind, writes, *policies)
        for own, namespace in node.get_node_names_and_namespaces()[:MOST_TOPICS]:
            name = _joined(namespace, own)
            try:
                served = node.get_service_names_and_types_by_node(own, namespace)
                asked = node.get_client_names_and_types_by_node(own, namespace)
            except Exception:  # of rclpy: the node is gone meanwhile
                continue
            for writes, listed in ((False, served), (True, asked)):
                for service, kinds in listed:
                    yield EndpointInfo(name, f"request {service}", kinds[0], writes)


def _node(name: str, context: Context | None) -> Node:
    return Node(name, context=context, start_parameter_services=False, enable_rosout=False)


def _joined(namespace: str, name: str) -> str:
    return f"{namespace.rstrip('/')}/{name}"


def main(argv: list[str]) -> int:
    """Run one graded simulation; the grader reads the exit code."""
    protect_process()
    link = socket.socket(fileno=int(argv[0]))
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    plan, first_node_s = Plan.from_json(argv[2]), float(argv[3])
    try:
        GradedSimulator(link, Path(argv[1]), plan, first_node_s, argv[4]).run()
    except SceneFailure as failure:
        send_message(link, "failed", reason=failure.message.serialise())
    rclpy.shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
