"""Measure and print for the benchmarks: time, processor time, memory, the machine, yardsticks.

Processor time is that of a control group (cgroup), as the kernel counts it: user and system time of
every process that was ever in it, also of those that had ended, were forked by others or were never
waited for. If this process may not make such a group (a container without rights), the tables show
"-": no other way counts all of them.

Memory is the group's peak: all processes together, shared pages once, with the file cache that they
filled.

Two yardsticks show the cost of rclpy itself on this machine, as units for the cost of gradings.
Both are whole processes, from their start to their end:

    python benchmarks/measuring.py start    a bare rclpy process: import, init, a node, shutdown
    python benchmarks/measuring.py floor    receives and handles as many poses, from itself and by
                                            rclpy's executor, as a run of the reference controller
                                            has ticks
"""

from __future__ import annotations

import importlib.metadata
import os
import platform
import signal
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import TypeVar

import psutil

#: Ticks of the reference controller's nominal run.
POSES = 3449
ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # all benchmarks are of this checkout, whatever is installed
T = TypeVar("T")


@dataclass(frozen=True)
class Cost:
    """The cost of something; None where it could not be measured.

    Attributes:
        wall_s: wall time [s].
        cpu_s: user and system time of all its processes [s].
        peak_mib: the peak of its memory [MiB].
    """

    wall_s: float
    cpu_s: float | None = None
    peak_mib: float | None = None


def in_turns(repetitions: int, *works: Callable[[], T]) -> list[list[T]]:
    """Repeat several measurements in turns, so that other load on the machine affects each."""
    rounds = [[work() for work in works] for _ in range(repetitions)]
    return [list(values) for values in zip(*rounds, strict=True)]


def median(samples: Sequence[Cost]) -> Cost:
    """Return the medians of some samples."""
    cpu_s = [sample.cpu_s for sample in samples if sample.cpu_s is not None]
    peak_mib = [sample.peak_mib for sample in samples if sample.peak_mib is not None]
    return Cost(
        statistics.median(sample.wall_s for sample in samples),
        statistics.median(cpu_s) if cpu_s else None,
        statistics.median(peak_mib) if peak_mib else None,
    )


# Printing -------------------------------------------------------------------------------------


def head(*titles: str) -> None:
    """Print the first row of a Markdown table, and the one below it."""
    print()
    row(*titles)
    print("|---" + "|--:" * (len(titles) - 1) + "|")


def row(*cells: object) -> None:
    """Print a row of a Markdown table."""
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def spread(values: Iterable[float | None], digits: int = 2) -> str:
    """Format values as their median (lowest-highest); "-" if there are none."""
    known = [value for value in values if value is not None]
    if not known:
        return "-"
    middle, low, high = (
        f"{value:,.{digits}f}" for value in (statistics.median(known), min(known), max(known))
    )
    return middle if len(known) == 1 else f"{middle} ({low}-{high})"


def ratio(value: Cost, unit: Cost) -> str:
    """Format a cost in multiples of another one: wall / CPU."""
    cpu = "-" if value.cpu_s is None or not unit.cpu_s else f"{value.cpu_s / unit.cpu_s:.1f}"
    return f"{value.wall_s / unit.wall_s:.1f} / {cpu}"


def machine() -> str:
    """Return which machine this is, how busy, and what runs on it."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    model = next((line.partition(":")[2].strip() for line in lines if "model name" in line), "?")
    cores, rclpy = len(os.sched_getaffinity(0)), importlib.metadata.version("rclpy")
    return (
        f"{model}, {cores} cores; Python {platform.python_version()}, rclpy {rclpy}; "
        f"{datetime.now():%Y-%m-%d %H:%M}, load before (1, 5, 15 minutes) {load()}"
    )


def load() -> str:
    """Return how busy the machine is."""
    return " ".join(f"{value:.1f}" for value in os.getloadavg())


# Groups of processes --------------------------------------------------------------------------


@dataclass
class Group:
    """Processes that are measured together.

    Attributes:
        name: of its folder in each hierarchy of control groups.
        parents: controller -> the folder of this process's group, below which the new one is made;
            "" for cgroup v2.
    """

    name: str
    parents: Mapping[str, Path]

    @contextmanager
    def entered(self) -> Iterator[None]:
        """Move this process into the group for a moment: those that it starts then stay there."""
        for parent in set(self.parents.values()):
            _enter(parent / self.name)
        try:
            yield
        finally:
            for parent in set(self.parents.values()):
                _enter(parent)

    def now(self) -> Cost:
        """Return the time, and what of a processor was used up to it."""
        return Cost(time.monotonic(), self.cpu_s())

    def since(self, begun: Cost) -> Cost:
        """Return what was used since `now` returned this; the peak is that of all the time."""
        now, cpu_s = self.now(), None
        if now.cpu_s is not None and begun.cpu_s is not None:
            cpu_s = now.cpu_s - begun.cpu_s
        return Cost(now.wall_s - begun.wall_s, cpu_s, self.peak_mib())

    def cpu_s(self) -> float | None:
        """Return user and system time up to now [s]; what runs this moment may lack a tick."""
        if file := self._file("", "cpu.stat"):
            words = file.read_text().split()
            return int(words[words.index("usage_usec") + 1]) / 1e6
        file = self._file("cpuacct", "cpuacct.usage")
        return int(file.read_text()) / 1e9 if file else None

    def peak_mib(self) -> float | None:
        """Return the most memory up to now [MiB]."""
        file = self._file("", "memory.peak") or self._file("memory", "memory.max_usage_in_bytes")
        return int(file.read_text()) / 2**20 if file else None

    def end(self) -> None:
        """Kill the processes that are still in it, and remove it."""
        deadline = time.monotonic() + 5.0
        for folder in {parent / self.name for parent in self.parents.values()}:
            while time.monotonic() < deadline:
                for number in (folder / "cgroup.procs").read_text().split():
                    with suppress(ProcessLookupError):
                        os.kill(int(number), signal.SIGKILL)
                try:
                    folder.rmdir()
                    break
                except OSError:
                    time.sleep(0.01)

    def _file(self, controller: str, name: str) -> Path | None:
        parent = self.parents.get(controller)
        file = parent / self.name / name if parent else None
        return file if file and file.exists() else None


@contextmanager
def group() -> Iterator[Group]:
    """Make a group below the current one in each hierarchy that is needed and writable.

    What is left in it is ended.
    """
    name = f"turtlesim-bench-{os.getpid()}-{time.monotonic_ns()}"
    usable: dict[str, Path] = {}
    for controllers, parent in _current_groups():
        folder = parent / name
        try:
            folder.mkdir()
            # only entering it shows whether a process may
            _enter(folder)
            _enter(parent)
        except OSError:
            with suppress(OSError):
                folder.rmdir()
            continue
        usable |= dict.fromkeys(controllers, parent)
    made = Group(name, usable)
    try:
        yield made
    finally:
        made.end()


def _enter(folder: Path) -> None:
    (folder / "cgroup.procs").write_text(str(os.getpid()))


def _current_groups() -> Iterator[tuple[list[str], Path]]:
    """Yield the folders of this process's groups, with their controllers; v2's is ""."""
    mounts = [line.split() for line in Path("/proc/mounts").read_text().splitlines()]
    for line in Path("/proc/self/cgroup").read_text().splitlines():
        _, names, path = line.split(":", 2)
        controllers = [name for name in names.split(",") if name in ("", "cpuacct", "memory")]
        kind = "cgroup" if names else "cgroup2"
        for mount in mounts:
            ours = mount[2] == kind and (not names or names in mount[3] or mount[1].endswith(names))
            if controllers and ours:
                yield controllers, Path(mount[1]) / path.lstrip("/")
                break


# Measuring ------------------------------------------------------------------------------------


def command(words: Sequence[str], env: Mapping[str, str] | None = None) -> Cost:
    """Run a command to its end.

    Raises:
        SystemExit: it failed.
    """
    with group() as measured, tempfile.TemporaryFile() as output:
        begun = measured.now()
        with measured.entered():
            process = subprocess.Popen(words, cwd=ROOT, env=env, stdout=output, stderr=output)
        failed = process.wait()
        cost = measured.since(begun)
        if failed:
            output.seek(0)
            raise SystemExit(f"{output.read().decode()}\n{' '.join(words)}: exit {failed}")
        return cost


def peak_pss_mib(words: Sequence[str], env: Mapping[str, str] | None = None) -> float:
    """Run a command, and return the most memory of it and all below it at once [MiB].

    Shared pages count once, in proportion. Looking takes time: measure none beside it.
    """
    most = 0.0
    null = subprocess.DEVNULL
    with psutil.Popen(words, cwd=ROOT, env=env, stdout=null, stderr=null) as process:
        while process.poll() is None:
            with suppress(psutil.Error):
                family = [process.pid, *(each.pid for each in process.children(recursive=True))]
                most = max(most, sum(map(_pss_mib, family)))
            time.sleep(0.03)
    return most


def _pss_mib(pid: int) -> float:
    with suppress(OSError, StopIteration, ValueError):
        lines = Path(f"/proc/{pid}/smaps_rollup").read_text().splitlines()
        return int(next(line for line in lines if line.startswith("Pss:")).split()[1]) / 1024
    return 0.0


# Yardsticks -----------------------------------------------------------------------------------


def start() -> None:
    """Import, init, a node, shutdown."""
    import rclpy

    rclpy.init()
    node = rclpy.create_node("bare")
    node.destroy_node()
    rclpy.shutdown()


def floor() -> None:
    """Publish pose after pose, and handle each."""
    import rclpy
    from rclpy.executors import SingleThreadedExecutor
    from turtlesim.msg import Pose

    rclpy.init()
    node = rclpy.create_node("floor")
    places: list[float] = []
    node.create_subscription(Pose, "turtle1/pose", lambda pose: places.append(pose.x), 10)
    publisher = node.create_publisher(Pose, "turtle1/pose", 10)
    executor = SingleThreadedExecutor()
    executor.add_node(node)
    for number in range(POSES):
        publisher.publish(Pose(x=float(number), y=5.5, theta=0.5, linear_velocity=2.0))
        while len(places) <= number:
            executor.spin_once()
    executor.shutdown()
    node.destroy_node()
    rclpy.shutdown()


def bare(env: Mapping[str, str]) -> Cost:
    """Measure the yardstick `start`."""
    return command([sys.executable, __file__, "start"], env)


def yardsticks(env: Mapping[str, str], repetitions: int) -> list[list[Cost]]:
    """Measure both yardsticks, in turns."""
    names = ("start", "floor")
    both = (partial(command, [sys.executable, __file__, name], env) for name in names)
    return in_turns(repetitions, *both)


if __name__ == "__main__":
    {"start": start, "floor": floor}[sys.argv[1]]()
