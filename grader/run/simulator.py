"""The simulator's process in a graded run: a turtlesim node, a recorder, and the end of the run.

    python -m grader.run.simulator FD FOLDER LIMITS

It speaks JSON lines with the grader over the inherited socket FD: out go `ready`, `progress` about
once a second, and `done` when the recording lies in FOLDER; in come `start` when the submission's
process is started, and `exited` when it has ended. If the
grader goes away, so does the simulator.
"""

from __future__ import annotations

import json
import signal
import socket
import sys
from pathlib import Path

import rclpy
from rclpy.signals import SignalHandlerOptions

from grader.exercise import Limits
from grader.run.recorder import Recorder
from turtlesim_py import pacer
from turtlesim_py.node import TurtlesimNode
from turtlesim_py.world.turtle import TICK_S, Pose

#: How long after its exit a submission's last messages may still arrive [ticks].
GRACE_TICKS = 31
#: How often the graph is looked at for what the submission publishes, and progress is told [ticks].
LOOK_TICKS = 63


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

    def __init__(self, link: socket.socket, folder: Path, limits: Limits) -> None:
        self._link = link
        self._folder = folder
        self._node = TurtlesimNode(["--ros-args", "-p", "turtle_image:=rolling"])
        self._recorder = Recorder(self._node.arena)
        self._end = EndOfRun(limits)
        self._own = (self._node.get_name(), self._node.get_namespace())
        self._topics: dict[str, str] = {}
        self._running = False

    def run(self) -> None:
        """Serve until the run is over, then save the recording."""
        self._link.setblocking(False)
        self._say("ready")
        reason = ""

        def tick() -> bool:
            nonlocal reason
            readings = self._node.tick()
            self._hear()
            if not self._running:
                return True
            self._recorder.take(readings)
            if self._recorder.ticks % LOOK_TICKS == 1:
                self._look_at_graph()
                self._say("progress", seconds=round(self._recorder.ticks * TICK_S, 1))
            first = readings.get("turtle1")
            reason = self._end.after(self._recorder.ticks, first.pose if first else None)
            return not reason

        pacer.follow_wall_clock(tick)
        self._look_at_graph()
        topics = tuple({"topic": t, "type": kind} for t, kind in sorted(self._topics.items()))
        self._recorder.recording(topics).save(self._folder)
        self._say("done", reason=reason)

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
                    self._running = True
                case "exited":
                    self._end.submission_gone()

    def _look_at_graph(self) -> None:
        """Note on which topics others publish: the usual mistake is a wrong name."""
        for name, namespace in self._node.get_node_names_and_namespaces():
            if (name, namespace) == self._own:
                continue
            try:
                found = self._node.get_publisher_names_and_types_by_node(name, namespace)
            except rclpy.node.NodeNameNonExistentError:
                continue
            for topic, types in found:
                if topic not in ("/rosout", "/parameter_events"):
                    self._topics[topic] = types[0]


def main(argv: list[str]) -> int:
    """Run one graded simulation; the grader reads the exit code."""
    # Ctrl-C in a terminal reaches the whole group; the grader decides what happens then.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    link = socket.socket(fileno=int(argv[0]))
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    GradedSimulator(link, Path(argv[1]), Limits(**json.loads(argv[2]))).run()
    rclpy.shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
