"""How the benchmarks measure: time, processor time, memory, half a processor, and the machine.

Processor time is the kernel's own count for a control group of its own (cgroup): user and system
time of every process that was ever in it, also of those that had ended, were forked by others or
were waited for by nobody. Where this process may not make such a group (a container without rights,
a system other than Linux), the tables show "-" for it: no other way counts all of them.

Memory is the group's peak: everything at once, shared pages once, with the file cache that the
processes filled.
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
import threading
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

#: Between two looks at the processor time of a run, to divide it among its stages [s].
LOOK_S = 0.005
#: The length in which a share of a processor is dealt out [us]; Docker's `--cpus` takes the same.
PERIOD_US = 100_000
ROOT = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class Sample:
    """What something took; None where it could not be measured.

    Attributes:
        wall_s: [s]
        cpu_s: user and system time of all its processes [s].
        peak_mib: the most memory it had [MiB].
    """

    wall_s: float
    cpu_s: float | None = None
    peak_mib: float | None = None


def spread(values: Iterable[float | None], digits: int = 2) -> str:
    """Median (lowest - highest), or "-"."""
    known = [value for value in values if value is not None]
    if not known:
        return "-"
    low, high = min(known), max(known)
    return f"{statistics.median(known):.{digits}f} ({low:.{digits}f}-{high:.{digits}f})"


def machine() -> str:
    """Which machine this is, how busy, and what runs on it."""
    lines: list[str] = []
    with suppress(OSError):
        lines = Path("/proc/cpuinfo").read_text().splitlines()
    model = next((line.partition(":")[2].strip() for line in lines if "model name" in line), "?")
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    try:
        rclpy = importlib.metadata.version("rclpy")
    except importlib.metadata.PackageNotFoundError:
        rclpy = "?"
    load = " ".join(f"{value:.1f}" for value in os.getloadavg())
    return (
        f"{model}, {cores} cores; Python {platform.python_version()}, rclpy {rclpy}; "
        f"{datetime.now():%Y-%m-%d %H:%M}, load before (1, 5, 15 minutes) {load}"
    )


# Groups of processes --------------------------------------------------------------------------


@dataclass
class Group:
    """Processes that are measured together.

    Attributes:
        folders: controller -> the folder in which the kernel tells of it; "" is cgroup v2's own.
        core: the only core that its processes may use, or None.
    """

    folders: Mapping[str, Path] = field(default_factory=dict)
    core: int | None = None

    def start(self, command: Sequence[str], **more: object) -> subprocess.Popen[str]:
        """Start a process in the group; `more` is for Popen."""
        doors = [str(folder / "cgroup.procs") for folder in set(self.folders.values())]
        enter = 'while [ "$1" != -- ]; do echo $$ > "$1" || exit 99; shift; done; shift; exec "$@"'
        before = os.sched_getaffinity(0) if self.core is not None else set()
        if self.core is not None:
            os.sched_setaffinity(0, {self.core})  # of this thread; the child inherits it
        try:
            words = ["sh", "-c", enter, "sh", *doors, "--", *command]
            return subprocess.Popen(words, text=True, **more)  # type: ignore[call-overload, no-any-return]
        finally:
            if before:
                os.sched_setaffinity(0, before)

    def cpu_s(self) -> float | None:
        """User and system time up to now [s]; whoever runs this moment may lack a tick."""
        if "" in self.folders:
            words = (self.folders[""] / "cpu.stat").read_text().split()
            return int(words[words.index("usage_usec") + 1]) / 1e6
        if "cpuacct" in self.folders:
            return int((self.folders["cpuacct"] / "cpuacct.usage").read_text()) / 1e9
        return None

    def peak_mib(self) -> float | None:
        """The most memory up to now [MiB]."""
        for controller, name in (("", "memory.peak"), ("memory", "memory.max_usage_in_bytes")):
            if controller in self.folders:
                with suppress(OSError):
                    return int((self.folders[controller] / name).read_text()) / 2**20
        return None

    def limit(self, cpus: float) -> bool:
        """Give all its processes together so much of a processor; False where that is not ours."""
        quota_us = int(cpus * PERIOD_US)
        for controller, name, text in (
            ("", "cpu.max", f"{quota_us} {PERIOD_US}"),
            ("cpu", "cpu.cfs_quota_us", f"{quota_us}"),
        ):
            file = self.folders.get(controller, Path("/nowhere")) / name
            if file.exists():
                with suppress(OSError):
                    file.write_text(text)
                    return True
        return False

    def end(self) -> None:
        """End whoever is still in it, and remove it."""
        deadline = time.monotonic() + 5.0
        for folder in set(self.folders.values()):
            while time.monotonic() < deadline:
                for number in (folder / "cgroup.procs").read_text().split():
                    with suppress(ProcessLookupError):
                        os.kill(int(number), signal.SIGKILL)
                try:
                    folder.rmdir()
                    break
                except OSError:
                    time.sleep(0.01)


@contextmanager
def group(cpus: float | None = None) -> Iterator[Group]:
    """A new group; with `cpus`, its processes get that much of a processor.

    Where the kernel lets us deal out no share, a process that never rests shares one core with the
    group, which gives it about half: see `how_limited`.
    """
    with ExitStack() as held:
        made = Group(dict(_new_folders()))
        held.callback(made.end)
        if cpus is not None and not made.limit(cpus):
            made.core = min(os.sched_getaffinity(0))
            held.enter_context(busy_neighbour(made.core))
        yield made


def how_limited(cpus: float) -> str:
    """In words, how `group(cpus)` limits here."""
    found = Group(dict(_new_folders()))
    try:
        by_kernel = found.limit(cpus)
    finally:
        found.end()
    return "cgroup quota" if by_kernel else "a busy neighbour on the one core it may use"


@contextmanager
def busy_neighbour(core: int) -> Iterator[None]:
    """A process that never rests, on one core."""
    idle = f"import os\nos.sched_setaffinity(0, {{{core}}})\nwhile os.getppid() == {os.getpid()}: 0"
    with subprocess.Popen([sys.executable, "-c", idle]) as process:
        try:
            yield
        finally:
            process.kill()


def _new_folders() -> Iterator[tuple[str, Path]]:
    """Make a group below our own in each hierarchy that we need and may change."""
    name = f"turtlesim-bench-{os.getpid()}-{time.monotonic_ns()}"
    made: dict[Path, Path] = {}
    for controllers, own in _own_groups():
        folder = own / name
        try:
            folder.mkdir()
            # whether a process may enter is known only when one does
            door = str(folder / "cgroup.procs")
            subprocess.run(["sh", "-c", f'echo $$ > "{door}"'], check=True, capture_output=True)
        except (OSError, subprocess.CalledProcessError):
            with suppress(OSError):
                folder.rmdir()
            continue
        made[own] = folder
        for controller in controllers:
            yield controller, folder


def _own_groups() -> Iterator[tuple[list[str], Path]]:
    """The folders of the groups that we are in, with their controllers; v2's is ""."""
    try:
        lines = Path("/proc/self/cgroup").read_text().splitlines()
        mounts = [line.split() for line in Path("/proc/mounts").read_text().splitlines()]
    except OSError:
        return
    for line in lines:
        _, names, path = line.split(":", 2)
        controllers = [
            name for name in names.split(",") if name in ("", "cpu", "cpuacct", "memory")
        ]
        kind = "cgroup" if names else "cgroup2"
        for mount in mounts:
            ours = mount[2] == kind and (not names or names in mount[3] or mount[1].endswith(names))
            if controllers and ours:
                yield controllers, Path(mount[1]) / path.lstrip("/")
                break


# Measuring ------------------------------------------------------------------------------------


def command(
    words: Sequence[str], env: Mapping[str, str] | None = None, cpus: float | None = None
) -> Sample:
    """Run a command to its end.

    Raises:
        SystemExit: it failed.
    """
    with group(cpus) as ours, tempfile.TemporaryFile() as said:
        begun = time.monotonic()
        process = ours.start(words, cwd=ROOT, env=env, stdout=said, stderr=said)
        failed = process.wait()
        wall_s = time.monotonic() - begun
        if failed:
            said.seek(0)
            raise SystemExit(f"{said.read().decode()}\n{' '.join(words)}: exit {failed}")
        return Sample(wall_s, ours.cpu_s(), ours.peak_mib())


class Watch:
    """Looks at a group's processor time again and again, to say how much there was when."""

    def __init__(self, watched: Group) -> None:
        self._watched = watched
        self._looks: list[tuple[float, float]] = []
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._look, daemon=True)

    def __enter__(self) -> Watch:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._done.set()
        self._thread.join()

    def between(self, begin_s: float, end_s: float) -> float | None:
        """The processor time between two times of the monotonic clock [s]."""
        if len(self._looks) < 2:
            return None
        return self._at(end_s) - self._at(begin_s)

    def _at(self, when_s: float) -> float:
        """Interpolated between the looks before and after."""
        looks = list(self._looks)
        after = next((n for n, (at, _) in enumerate(looks) if at >= when_s), len(looks) - 1)
        (t0, cpu0), (t1, cpu1) = looks[max(after - 1, 0)], looks[after]
        return cpu1 if t1 <= t0 else cpu0 + (cpu1 - cpu0) * min((when_s - t0) / (t1 - t0), 1.0)

    def _look(self) -> None:
        while not self._done.wait(LOOK_S):
            used = self._watched.cpu_s()
            if used is None:
                return
            self._looks.append((time.monotonic(), used))
