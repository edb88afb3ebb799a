"""The simulator's process in a graded run: a turtlesim node, a recorder, and the end of the run.

    python -m grader.run.simulator.real_time FD FILE LIMITS START

It speaks JSON lines with the grader over the inherited socket FD: out go `ready`, `progress` about
once a second, and `done` when the recording lies in FILE; in come `start` when the submission's
process is started, and `exited` when it has ended. The clock of the run starts when the submission
has its first node, has ended, or has had FIRST_NODE_S for it. If the grader goes away, so does the
simulator.
"""

from __future__ import annotations

import json
import math
import signal
import socket
import sys
import time
from pathlib import Path

import rclpy
from rclpy.signals import SignalHandlerOptions

from grader.exercise.loading import Limits
from grader.recording.recording import Start
from grader.run import stage
from grader.run.student.main import die_with_parent
from grader.scenes.turtlesim.recorder import Recorder
from turtlesim_py.ros import pacer
from turtlesim_py.ros.node import TurtlesimNode
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.floats import float32
from turtlesim_py.world.turtle import SIZE_M, TICK_S, Pose

#: How long after its exit a submission's last messages may still arrive [ticks].
GRACE_TICKS = 31
#: How often the graph is looked at for what the submission publishes, and progress is told [ticks].
LOOK_TICKS = 63
EVENTS = "/parameter_events"
#: How long the clock of the run waits for the submission's first node [s].
FIRST_NODE_S = 8.0


class EndOfRun:
    """Decides when there is nothing more to see.

    The turtle has moved and rested; or nothing has moved for too long; or the submission is gone
    and nothing moved; or time is up.
    """

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._last_pose: Pose | None = None
        self._moved = False
        self._still_ticks = 0
        self._gone_ticks: int | None = None

    @property
    def is_at_rest(self) -> bool:
        """Whether the turtle has moved, and does not now."""
        return self._moved and self._still_ticks > 0

    def submission_gone(self) -> None:
        """The submission's process has ended."""
        self._gone_ticks = 0

    def after(self, tick: int, pose: Pose | None) -> str:
        """The reason to stop after this tick: `rest`, `no_motion`, `gone`, `time_limit`, or ''."""
        self._watch(pose)
        if self._gone_ticks is not None:
            self._gone_ticks += 1
        if tick * TICK_S >= self._limits.total_s:
            return "time_limit"
        if self._moved:
            return "rest" if self._still_ticks * TICK_S >= self._limits.rest_s else ""
        if self._gone_ticks is not None and self._gone_ticks >= GRACE_TICKS:
            return "gone"
        return "no_motion" if tick * TICK_S >= self._limits.first_motion_s else ""

    def _watch(self, pose: Pose | None) -> None:
        still = pose is None or self._last_pose is None or pose[:3] == self._last_pose[:3]
        self._moved = self._moved or not still
        self._still_ticks = self._still_ticks + 1 if still else 0
        self._last_pose = pose


class GradedSimulator:
    """A turtlesim node with a recorder, told by the grader what becomes of the submission."""

    def __init__(
        self, link: socket.socket, file: Path, limits: Limits, start: Start | None
    ) -> None:
        self._link = link
        self._file = file
        self._node = TurtlesimNode(["--ros-args", "-p", "turtle_image:=rolling"])
        place(self._node.arena, start)
        self._recorder = Recorder(self._node.arena)
        self._end = EndOfRun(limits)
        self._topics = PublishedTopics(self._node)
        self._running = False
        self._start_at_s = math.inf

    def run(self) -> None:
        """Serve until the run is over, then save the recording."""
        self._link.setblocking(False)
        self._say("ready")
        reason = ""

        def tick() -> bool:
            nonlocal reason
            self._hear()
            self._running = self._running or self._has_company()
            readings = self._node.tick()
            if not self._running:
                return True
            self._recorder.take(readings)
            if self._recorder.ticks % LOOK_TICKS == 1:
                self._topics.look()
                self._say("progress", seconds=round(self._recorder.ticks * TICK_S, 1))
            first = readings.get("turtle1")
            reason = self._end.after(self._recorder.ticks, first.pose if first else None)
            return not reason

        pacer.follow_wall_clock(tick)
        self._topics.look()
        stage.leave(self._recorder.recording(self._topics.found()), self._file)
        self._say("done", reason=reason)

    def _has_company(self) -> bool:
        """Whether the submission has a node; or it has had the time to make one."""
        if math.isinf(self._start_at_s):
            return False
        # Every node has this publisher, and what it publishes with is made known in order: at the
        # latest when its first command or call comes, this is true. Its name may come later.
        return time.monotonic() > self._start_at_s or self._node.count_publishers(EVENTS) > 1

    def _say(self, what: str, **more: str | float) -> None:
        self._link.setblocking(True)
        self._link.sendall(json.dumps({"say": what, **more}).encode() + b"\n")
        self._link.setblocking(False)

    def _hear(self) -> None:
        try:
            text = self._link.recv(4096)
        except BlockingIOError:
            return
        if not text:
            raise SystemExit(1)  # the grader is gone: nobody wants the recording any more
        for line in text.splitlines():
            match json.loads(line)["say"]:
                case "start":
                    self._start_at_s = time.monotonic() + FIRST_NODE_S
                case "exited":
                    self._running = True
                    self._end.submission_gone()


class PublishedTopics:
    """On which topics others publish: the usual mistake is a wrong name."""

    #: every node has these, and ROS publishes on them by itself
    USUAL = ("/rosout", EVENTS)

    def __init__(self, node: TurtlesimNode) -> None:
        self._node = node
        self._types: dict[str, str] = {}

    def look(self) -> int:
        """Note what the graph shows now; returns how many publishers others have, but of rosout."""
        node = self._node
        own = dict(
            node.get_publisher_names_and_types_by_node(node.get_name(), node.get_namespace())
        )
        total = 0
        for topic, types in node.get_topic_names_and_types():
            others = node.count_publishers(topic) - (topic in own)
            if others > 0 and topic != "/rosout":
                total += others
                if topic not in self.USUAL:
                    self._types[topic] = types[0]
        return total

    def found(self) -> tuple[dict[str, str], ...]:
        """What was noted, as in a recording."""
        return tuple({"topic": t, "type": kind} for t, kind in sorted(self._types.items()))


def place(arena: Arena, start: Start | None) -> None:
    """Put turtle1 where a run is to begin, without a stroke and before anything is recorded."""
    if start is not None:
        turtle = arena.turtles["turtle1"]
        turtle.x_m, turtle.y_down_m = float32(start.x), float32(SIZE_M - float32(start.y))
        turtle.heading_rad = float32(start.theta)


def main(argv: list[str]) -> int:
    """Run one graded simulation; the grader reads the exit code."""
    die_with_parent()
    # Ctrl-C in a terminal reaches the whole group; the grader decides what happens then.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    link = socket.socket(fileno=int(argv[0]))
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    limits, start = Limits(**json.loads(argv[2])), json.loads(argv[3])
    GradedSimulator(link, Path(argv[1]), limits, Start(**start) if start else None).run()
    rclpy.shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
