"""Measure what the simulator costs, beside the original: a table, in about five minutes.

    .venv/bin/python benchmarks/node.py

The figures of the original are those of `turtlesim_node` 1.8.2 with Qt's offscreen platform, on a
machine with 2 cores. No test reads any of these numbers: they are for people.
"""

from __future__ import annotations

import os
import random
import signal
import socket
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import measuring
import psutil
import rclpy
from geometry_msgs.msg import Twist, Vector3
from measuring import ROOT, T, head, in_turns, row, spread
from turtlesim.msg import Pose
from turtlesim.srv import Spawn
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from grader.run.processes import network

#: How often a figure is measured.
REPETITIONS = 5
#: How often and how long a process is measured for a figure of its cost [s].
WINDOWS = 3
WINDOW_S = 5.0
#: The rate of commands of the original's measurement [Hz].
COMMANDS_HZ = 10.0
#: A simulator that ends with its first pose: that to be heard varies by seconds, by discovery.
TO_FIRST_POSE = """
import os
from turtlesim_py.ros import node

def tick(self, now_ns, tick=node.TurtlesimNode.tick):
    tick(self, now_ns)
    os._exit(0)

node.TurtlesimNode.tick = tick
node.main(["turtlesim_node"])
"""
#: Processes that the simulator's memory is compared with; they wait for the end of their input.
IMPORTS = "import rclpy, rclpy.action, geometry_msgs.msg"
BARE = {
    "the imports of rclpy, rclpy.action, geometry_msgs": IMPORTS,
    "the same with a node": f"{IMPORTS}; rclpy.init(); node = rclpy.create_node('bare')",
}


def figure(
    name: str, unit: str, values: Sequence[float], digits: int = 1, original: str = ""
) -> None:
    """Print one line of the table."""
    row(name, unit, spread(values, digits), original)


class Subscriber:
    """An rclpy subscriber that listens to turtle1, and drives it on request."""

    def __init__(self) -> None:
        self.node = rclpy.create_node("benchmark")
        self.stamps_ns: list[int] = []
        self._velocity = self.node.create_publisher(Twist, "turtle1/cmd_vel", 7)
        self._spawn = self.node.create_client(Spawn, "spawn")
        self.node.create_subscription(Pose, "turtle1/pose", self._on_pose, 10)

    def _on_pose(self, _: Pose, info: Any) -> None:
        self.stamps_ns.append(info["source_timestamp"])

    def spin_until(self, condition: Callable[[], object]) -> None:
        """Listen until the condition holds."""
        deadline = time.monotonic() + 60.0
        while not condition():
            if time.monotonic() > deadline:
                raise TimeoutError
            rclpy.spin_once(self.node, timeout_sec=0.02)

    def spin_for(self, seconds: float, drive: bool = False) -> None:
        """Listen, and drive if asked to."""
        command = Twist(linear=Vector3(x=2.0), angular=Vector3(z=1.0))
        end = due = time.monotonic()
        end += seconds
        while (now := time.monotonic()) < end:
            if drive and now >= due:
                due += 1.0 / COMMANDS_HZ
                self._velocity.publish(command)
            rclpy.spin_once(self.node, timeout_sec=min(0.02, end - now))

    def gaps_ms(self, seconds: float, drive: bool = False) -> list[float]:
        """Listen, and return the times between the stamps of poses [ms]."""
        self.stamps_ns.clear()
        self.spin_for(seconds, drive)
        return [(b - a) / 1e6 for a, b in pairwise(self.stamps_ns)]

    def spawn(self, count: int) -> None:
        """Add turtles somewhere."""
        self.spin_until(self._spawn.service_is_ready)
        for _ in range(count):
            place = Spawn.Request(x=random.uniform(1, 10), y=random.uniform(1, 10))
            answer = self._spawn.call_async(place)
            self.spin_until(answer.done)


@contextmanager
def simulator(*arguments: str) -> Iterator[psutil.Process]:
    """Start a turtlesim_node of this checkout."""
    command = [sys.executable, "-m", "turtlesim_py.ros.node", *arguments]
    with subprocess.Popen(command, cwd=ROOT, stderr=subprocess.DEVNULL) as process:
        try:
            yield psutil.Process(process.pid)
        finally:
            process.send_signal(signal.SIGINT)


@contextmanager
def heard(subscriber: Subscriber, *arguments: str) -> Iterator[psutil.Process]:
    """Start a simulator, and wait until its poses arrive and its start is over."""
    with simulator(*arguments) as process:
        subscriber.stamps_ns.clear()
        subscriber.spin_until(lambda: subscriber.stamps_ns)
        subscriber.spin_for(2.0)
        yield process


def cpu_percent(process: psutil.Process, subscriber: Subscriber, drive: bool = False) -> float:
    """Return the share of a core that a process uses for a while."""
    begin, begin_s = time.monotonic(), cpu_s(process)
    subscriber.spin_for(WINDOW_S, drive)
    return 100.0 * (cpu_s(process) - begin_s) / (time.monotonic() - begin)


def cpu_s(process: psutil.Process) -> float:
    """Return the processor time of all its threads [s]; what psutil has is counted in 10 ms."""
    files = Path(f"/proc/{process.pid}/task").glob("*/schedstat")
    return sum(int(file.read_text().split()[0]) for file in files) / 1e9


def memory_mib(process: psutil.Process) -> float:
    """Return how much of a process is in memory [MiB]."""
    return float(process.memory_info().rss) / 2**20


def bare_memory_mib(statements: str) -> float:
    """Return the memory of a process that has executed these statements [MiB]."""
    words = [sys.executable, "-c", f"{statements}; print(flush=True); input()"]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as bare:
        assert bare.stdin is not None and bare.stdout is not None
        bare.stdout.readline()
        mib = memory_mib(psutil.Process(bare.pid))
        bare.stdin.write(b"\n")
        bare.stdin.flush()
    return mib


def cost_of_node(subscriber: Subscriber) -> None:
    """Print CPU and memory of the node, idle and driven, with one turtle and with ten."""
    with heard(subscriber) as process:
        idle = partial(cpu_percent, process, subscriber)
        driven = partial(idle, drive=True)
        mib = partial(memory_mib, process)
        bare = (partial(bare_memory_mib, statements) for statements in BARE.values())
        idle_percents, driven_percents, all_mib, *bare_mib = in_turns(
            REPETITIONS, idle, driven, mib, *bare
        )
        figure("CPU, idle, 1 subscriber", "%", idle_percents, 2, "2.7")
        figure("CPU, driven at 10 Hz, 1 subscriber", "%", driven_percents, 2, "6.8")
        figure("memory, 1 turtle", "MiB", all_mib, 1, "52")
        for name, others in zip(BARE, bare_mib, strict=True):
            above = [ours - other for ours, other in zip(all_mib, others, strict=True)]
            figure(f"... above {name}", "MiB", above)
        subscriber.spawn(9)
        (percents,) = in_turns(WINDOWS, driven)
        figure("CPU, 10 turtles, 1 driven", "%", percents, 2, "10.1")
        figure("memory, 10 turtles", "MiB", [mib()], 1, "60")


def start_to_first_pose() -> None:
    """Print the time until the first pose, beside that of a whole bare rclpy process."""

    def heard_s() -> float:
        subscriber = Subscriber()
        begin = time.monotonic()
        with simulator():
            subscriber.spin_until(lambda: subscriber.stamps_ns)
            waited_s = time.monotonic() - begin
        subscriber.node.destroy_node()
        return waited_s

    env = {**os.environ, "PYTHONPATH": str(ROOT)}
    words = [sys.executable, "-c", TO_FIRST_POSE]
    bare_words = [sys.executable, measuring.__file__, "start"]
    bare, first = in_turns(
        2 * REPETITIONS + 1,
        *(partial(measuring.command, each, env) for each in (bare_words, words)),
    )
    pairs = list(zip(bare, first, strict=True))
    figure("start to first pose", "s", [cost.wall_s for cost in first], 3)
    walls = [ours.wall_s / other.wall_s for other, ours in pairs]
    figure("... in bare rclpy processes", "", walls, 2)
    cpus = [
        ours.cpu_s / other.cpu_s if ours.cpu_s and other.cpu_s else None for other, ours in pairs
    ]
    row("... the same in processor time", "", spread(cpus, 2), "")
    (waits,) = in_turns(REPETITIONS, heard_s)
    figure("start to first pose at a subscriber", "s", waits, 2, "0.15 – 0.43")


def pose_interval(subscriber: Subscriber) -> None:
    """Print the time between the stamps of two poses of an idle turtle."""
    with heard(subscriber):
        gaps_ms = subscriber.gaps_ms(20.0)
        others = subscriber.node.count_publishers("turtle1/pose") - 1
        assert not others, "another simulator is in the same ROS domain"
    deviation = [statistics.stdev(gaps_ms)]
    figure("pose interval over 20 s, mean", "ms", [statistics.mean(gaps_ms)], 4, "16.0007")
    figure("pose interval over 20 s, standard deviation", "ms", deviation, 2, "0.65")
    figure("pose interval over 20 s, longest", "ms", [max(gaps_ms)], original="20.4")


@contextmanager
def viewers(port: int, count: int) -> Iterator[None]:
    """Connect so many clients to the page, which read everything that they are sent."""

    def read(connection: ClientConnection) -> None:
        with suppress(ConnectionClosed):
            for _ in connection:
                pass

    with ExitStack() as stack:
        for _ in range(count):
            connection = stack.enter_context(connect(f"ws://127.0.0.1:{port}/socket"))
            connection.send('{"op": "subscribe", "topic": "/turtlesim_live"}')
            threading.Thread(target=read, args=(connection,), daemon=True).start()
        yield


def cost_of_page(subscriber: Subscriber) -> None:
    """Print what the page costs the simulator, and how regular poses are with viewers."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]

    def beside(count: int, measure: Callable[[], T]) -> Callable[[], T]:
        def measured() -> T:
            with viewers(port, count):
                subscriber.spin_for(0.5)
                return measure()

        return measured

    with heard(subscriber, "--ros-args", "-p", f"view_port:={port}") as process:
        idle = partial(cpu_percent, process, subscriber)
        driven = partial(idle, drive=True)
        alone, viewed = in_turns(WINDOWS, beside(0, idle), beside(1, idle))
        one, ten = in_turns(WINDOWS, beside(1, driven), beside(10, driven))
        figure("CPU, idle, page without viewers", "%", alone)
        figure("CPU, idle, 1 viewer", "%", viewed)
        figure("CPU, driven, 1 viewer", "%", one)
        figure("CPU, driven, 10 viewers", "%", ten)
        gaps_ms = partial(subscriber.gaps_ms, 5.0, drive=True)
        without, with_ten = in_turns(2 * WINDOWS, beside(0, gaps_ms), beside(10, gaps_ms))
        for name, windows in (("no viewer", without), ("10 viewers", with_ten)):
            means, deviations = map(statistics.mean, windows), map(statistics.stdev, windows)
            figure(f"pose interval, driven, {name}, mean", "ms", list(means), 4)
            figure("... standard deviation", "ms", list(deviations), 2)


def main() -> None:
    """Print the table, each line when it is known."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # the simulator is not left behind
    head("", "unit", "median (lowest-highest)", "the original")
    with network.reserve_domain() as number:
        os.environ["ROS_DOMAIN_ID"] = str(number)
        os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
        rclpy.init(args=[])
        start_to_first_pose()
        for part in (cost_of_node, pose_interval, cost_of_page):
            subscriber = Subscriber()
            part(subscriber)
            subscriber.node.destroy_node()
        rclpy.shutdown()


if __name__ == "__main__":
    main()
