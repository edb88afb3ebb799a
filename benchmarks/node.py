"""What the simulator costs: its start, and a second of it, idle and with a turtle that is driven.

    .venv/bin/python benchmarks/node.py [--fast] [-o FILE.json]

Most of it is rclpy's: so a bare rclpy process, from its import to its end, is measured beside it.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pyperf

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # whatever is installed

from grader.run.processes import network  # noqa: E402

#: Before a second counts, the start is over; so many are measured [s].
SETTLED_S, WINDOW_S = 2.0, 5.0
BARE = "import rclpy; rclpy.init(); rclpy.create_node('bare').destroy_node(); rclpy.shutdown()"
#: A simulator that ends with its first tick.
TO_FIRST_TICK = """
import os
from turtlesim_py.ros import node

node.TurtlesimNode.tick = lambda *_: os._exit(0)
node.main(["turtlesim_node"])
"""


@contextmanager
def started(*words: str) -> Iterator[int]:
    """Start a program of this checkout; yield its process's id."""
    command = [sys.executable, *words]
    with subprocess.Popen(
        command, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    ) as process:
        try:
            yield process.pid
        finally:
            process.send_signal(signal.SIGINT)


def whole_s(statements: str) -> float:
    """Return how long a process is there that executes these statements [s]."""
    begun = time.perf_counter()
    subprocess.run(
        [sys.executable, "-c", statements], cwd=ROOT, check=True, stderr=subprocess.DEVNULL
    )
    return time.perf_counter() - begun


def cpu_of_a_second(*driver: str) -> float:
    """Return what the simulator uses in a second beside a program [CPU s]."""
    with started("-m", "turtlesim_py.ros.node") as simulator:
        if driver:
            with started(*driver):
                return _cpu_of_a_second(simulator)
        return _cpu_of_a_second(simulator)


def _cpu_of_a_second(process: int) -> float:
    time.sleep(SETTLED_S)
    begun, used_s = time.perf_counter(), _cpu_s(process)
    time.sleep(WINDOW_S)
    return (_cpu_s(process) - used_s) / (time.perf_counter() - begun)


def _cpu_s(process: int) -> float:
    """Return the processor time of all threads of a process [s]."""
    files = Path(f"/proc/{process}/task").glob("*/schedstat")
    return sum(int(file.read_text().split()[0]) for file in files) / 1e9


def main() -> None:
    """Measure all, where no other simulator is heard."""
    runner = pyperf.Runner(processes=3, values=3, warmups=1, loops=1)
    with network.reserve_domain() as number:
        os.environ["ROS_DOMAIN_ID"] = str(number)
        os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
        square = ("-m", "turtlesim_py.programs.draw_square")
        runner.bench_time_func("a bare rclpy process", lambda _: whole_s(BARE))
        runner.bench_time_func("node: start to first tick", lambda _: whole_s(TO_FIRST_TICK))
        runner.bench_time_func("node: CPU of a second, idle", lambda _: cpu_of_a_second())
        runner.bench_time_func("node: CPU of a second, driven", lambda _: cpu_of_a_second(*square))


if __name__ == "__main__":
    main()
