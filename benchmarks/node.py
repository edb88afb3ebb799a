"""What the simulator costs, beside what the original costs: prints a table, in about four minutes.

    .venv/bin/python benchmarks/node.py

The figures of the original are those of `turtlesim_node` 1.8.2 with Qt's offscreen platform, on a
machine with 2 cores. No test looks at any of these numbers: they are for people.
"""

from __future__ import annotations

import math
import os
import random
import signal
import socket
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # this checkout, whatever is installed

import psutil  # noqa: E402
import rclpy  # noqa: E402
from geometry_msgs.msg import Twist, Vector3  # noqa: E402
from turtlesim.msg import Pose  # noqa: E402
from turtlesim.srv import Spawn  # noqa: E402
from websockets.exceptions import ConnectionClosed  # noqa: E402
from websockets.sync.client import ClientConnection, connect  # noqa: E402

from grader.run.processes import domain  # noqa: E402
from turtlesim_py.world.arena import TICK_NS, Arena  # noqa: E402
from turtlesim_py.world.canvas import Canvas, Pen  # noqa: E402

#: How often a figure is taken.
REPETITIONS = 5
#: How often and how long a process is watched for a figure of its cost [s].
WINDOWS = 3
WINDOW_S = 2.5
#: The rate of commands of the original's measurement [Hz].
COMMANDS_HZ = 10.0


@dataclass
class Row:
    """One line of the table."""

    name: str
    unit: str
    values: list[float]
    original: str = ""
    digits: int = 1

    def __str__(self) -> str:
        middle, low, high = (
            f"{value:,.{self.digits}f}"
            for value in (statistics.median(self.values), min(self.values), max(self.values))
        )
        spread = f"{low} – {high}" if len(self.values) > 1 else ""
        return (
            f"| {self.name:44} | {self.unit:5} | {middle:>9} | {spread:>19} | {self.original:>13} |"
        )


class Subscriber:
    """The one rclpy subscriber: it listens to turtle1, and drives it where it is told to."""

    def __init__(self) -> None:
        self.node = rclpy.create_node("benchmark")
        self.stamps_ns: list[int] = []
        self._velocity = self.node.create_publisher(Twist, "turtle1/cmd_vel", 7)
        self._spawn = self.node.create_client(Spawn, "spawn")
        self.node.create_subscription(Pose, "turtle1/pose", self._on_pose, 10)

    def _on_pose(self, _: Pose, info: Any) -> None:
        self.stamps_ns.append(info["source_timestamp"])

    def spin_until(self, condition: Callable[[], object], patience_s: float = 60.0) -> None:
        """Listen until the condition holds."""
        deadline = time.monotonic() + patience_s
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

    def spawn(self, count: int) -> None:
        """Add turtles somewhere."""
        self.spin_until(self._spawn.service_is_ready)
        for _ in range(count):
            place = Spawn.Request(x=random.uniform(1, 10), y=random.uniform(1, 10))
            answer = self._spawn.call_async(place)
            self.spin_until(answer.done)


@contextmanager
def simulator(*arguments: str) -> Iterator[psutil.Process]:
    """A turtlesim_node of this checkout."""
    command = [sys.executable, "-m", "turtlesim_py.ros.node", *arguments]
    with subprocess.Popen(command, cwd=ROOT, stderr=subprocess.DEVNULL) as process:
        try:
            yield psutil.Process(process.pid)
        finally:
            process.send_signal(signal.SIGINT)


def cpu_percent(process: psutil.Process, work: Callable[[], None]) -> float:
    """The share of a core that a process takes while `work` lasts."""

    def used_s() -> float:
        times = process.cpu_times()
        return float(times.user + times.system)

    begin, used = time.monotonic(), used_s()
    work()
    return (used_s() - used) / (time.monotonic() - begin) * 100.0


def cost_of_node(subscriber: Subscriber) -> Iterator[Row]:
    """CPU and memory of the node, idle and driven, with one turtle and with ten."""

    def shares(drive: bool) -> list[float]:
        return [
            cpu_percent(process, lambda: subscriber.spin_for(WINDOW_S, drive))
            for _ in range(WINDOWS)
        ]

    def memory_mib() -> list[float]:
        return [process.memory_info().rss / 2**20]

    with simulator() as process:
        subscriber.stamps_ns.clear()
        subscriber.spin_until(lambda: subscriber.stamps_ns)
        subscriber.spin_for(2.0)
        yield Row("CPU, idle, 1 subscriber", "%", shares(drive=False), "2.7")
        yield Row("CPU, driven at 10 Hz, 1 subscriber", "%", shares(drive=True), "6.8")
        yield Row("memory, 1 turtle", "MiB", memory_mib(), "52", digits=0)
        subscriber.spawn(9)
        yield Row("CPU, 10 turtles, 1 driven", "%", shares(drive=True), "10.1")
        yield Row("memory, 10 turtles", "MiB", memory_mib(), "60", digits=0)


def start_to_first_pose() -> Iterator[Row]:
    """From the start of the process until a waiting client has a pose."""
    waits = []
    for _ in range(REPETITIONS):
        subscriber = Subscriber()
        begin = time.monotonic()
        with simulator():
            subscriber.spin_until(lambda s=subscriber: s.stamps_ns)  # type: ignore[misc]
            waits.append(time.monotonic() - begin)
        subscriber.node.destroy_node()
    yield Row("start to first pose", "s", waits, "0.15 – 0.43", digits=2)


def pose_interval(subscriber: Subscriber) -> Iterator[Row]:
    """Between the stamps of two poses of an idle turtle."""
    with simulator():
        subscriber.spin_until(lambda: subscriber.stamps_ns)
        subscriber.spin_for(2.0)
        subscriber.stamps_ns.clear()
        subscriber.spin_for(20.0)
        others = subscriber.node.count_publishers("turtle1/pose") - 1
        assert not others, "another simulator is in the same ROS domain"
    stamps = subscriber.stamps_ns
    gaps_ms = [(b - a) / 1e6 for a, b in pairwise(stamps)]
    yield Row("pose interval over 20 s, mean", "ms", [statistics.mean(gaps_ms)], "16.0007", 4)
    yield Row(
        "pose interval over 20 s, standard deviation", "ms", [statistics.stdev(gaps_ms)], "0.65", 2
    )
    yield Row("pose interval over 20 s, longest", "ms", [max(gaps_ms)], "20.4")


@contextmanager
def viewers(port: int, count: int) -> Iterator[None]:
    """So many who look at the page, and take everything that they are sent."""

    def look(connection: ClientConnection) -> None:
        with suppress(ConnectionClosed):
            for _ in connection:
                pass

    with ExitStack() as stack:
        for _ in range(count):
            connection = stack.enter_context(connect(f"ws://127.0.0.1:{port}/socket"))
            connection.send('{"op": "subscribe", "topic": "/turtlesim_live"}')
            threading.Thread(target=look, args=(connection,), daemon=True).start()
        yield


def cost_of_page(subscriber: Subscriber) -> Iterator[Row]:
    """What the page costs the simulator, and whether poses stay as regular, with viewers."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]

    def share(drive: bool) -> float:
        return cpu_percent(process, lambda: subscriber.spin_for(WINDOW_S, drive))

    def gaps_ms() -> list[float]:
        subscriber.stamps_ns.clear()
        subscriber.spin_for(5.0, drive=True)
        return [(b - a) / 1e6 for a, b in pairwise(subscriber.stamps_ns)]

    with simulator("--ros-args", "-p", f"view_port:={port}") as process:
        subscriber.stamps_ns.clear()
        subscriber.spin_until(lambda: subscriber.stamps_ns)
        subscriber.spin_for(2.0)
        alone: list[float] = []
        looked_at: list[float] = []
        for _ in range(WINDOWS):  # in turns: what else the machine does concerns both
            alone.append(share(drive=False))
            with viewers(port, 1):
                subscriber.spin_for(0.5)
                looked_at.append(share(drive=False))
        yield Row("CPU, idle, page that nobody looks at", "%", alone)
        yield Row("CPU, idle, 1 viewer", "%", looked_at)
        with viewers(port, 1):
            yield Row("CPU, driven, 1 viewer", "%", [share(drive=True) for _ in range(WINDOWS)])
        with viewers(port, 10):
            yield Row("CPU, driven, 10 viewers", "%", [share(drive=True) for _ in range(WINDOWS)])
        without: list[list[float]] = []
        with_ten: list[list[float]] = []
        for _ in range(2 * WINDOWS):  # in turns, too
            without.append(gaps_ms())
            with viewers(port, 10):
                subscriber.spin_for(0.5)
                with_ten.append(gaps_ms())
        for name, windows in (("no viewer", without), ("10 viewers", with_ten)):
            means, spreads = map(statistics.mean, windows), map(statistics.stdev, windows)
            yield Row(f"pose interval, driven, {name}, mean", "ms", list(means), digits=4)
            yield Row("... standard deviation", "ms", list(spreads), digits=2)


def most_turtles(subscriber: Subscriber) -> Iterator[Row]:
    """How many turtles hold 62.5 Hz while the node has one core only.

    Turtles are added, a sixth more each time, until the poses of turtle1 come on average later
    than every 16.2 ms, in three tries: other programs want that core too.
    """

    def holds_the_rate() -> bool:
        subscriber.stamps_ns.clear()
        subscriber.spin_for(2.0)
        stamps = subscriber.stamps_ns
        gaps = len(stamps) - 1
        return gaps > 0 and (stamps[-1] - stamps[0]) / gaps < 1.0125 * TICK_NS

    with simulator() as process:
        subscriber.spin_until(lambda: subscriber.stamps_ns)
        core = min(os.sched_getaffinity(process.pid))
        for thread in process.threads():
            os.sched_setaffinity(thread.id, {core})
        count, most = 1, 0
        while any(holds_the_rate() for _ in range(3)):
            most = count
            more = math.ceil(count / 6) if count >= 16 else count
            subscriber.spawn(more)
            subscriber.spin_for(0.5)
            count += more
    yield Row("turtles at 62.5 Hz on one core", "", [most], digits=0)


def per_second(work: Callable[[int], None], count: int) -> list[float]:
    """How often a second `work(count)` does what it does `count` times."""
    rates = []
    for _ in range(REPETITIONS):
        begin = time.perf_counter()
        work(count)
        rates.append(count / (time.perf_counter() - begin))
    return rates


def bare_world() -> Iterator[Row]:
    """The world without ROS."""

    def ticks(count: int) -> None:
        arena = Arena()
        for tick in range(count):
            if tick % 30 == 0:
                arena.command("turtle1", (2.0, 0.0, 0.0), (0.0, 0.0, 1.0))
            arena.tick()

    def strokes(count: int) -> None:
        canvas, pen = Canvas(), Pen()
        for number in range(count):
            angle = number * 0.016
            x, y = 250.0 + 90.0 * math.sin(angle), 250.0 + 90.0 * math.cos(angle)
            canvas.draw_line(x + 1.4 * math.cos(angle), y - 1.4 * math.sin(angle), x, y, pen)

    yield Row(
        "ticks of the bare world, 1 driven turtle", "1/s", per_second(ticks, 20_000), digits=0
    )
    yield Row("strokes of a tick's length", "1/s", per_second(strokes, 20_000), digits=0)


def main() -> None:
    """Print the table, each line when it is known."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # the simulator is not left behind
    print(f"| {'':44} | {'':5} | {'median':>9} | {'lowest – highest':>19} | {'the original':>13} |")
    print(f"|{'-' * 46}|{'-' * 7}|{'-' * 10}:|{'-' * 20}:|{'-' * 14}:|")
    for row in bare_world():
        print(row, flush=True)
    with domain.reserve_domain() as number:
        os.environ["ROS_DOMAIN_ID"] = str(number)
        os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
        rclpy.init(args=[])
        for row in start_to_first_pose():
            print(row, flush=True)
        for part in (cost_of_node, pose_interval, cost_of_page, most_turtles):
            subscriber = Subscriber()
            for row in part(subscriber):
                print(row, flush=True)
            subscriber.node.destroy_node()
        rclpy.shutdown()


if __name__ == "__main__":
    main()
