"""Measure what a grading costs: tables in Markdown, in about two minutes.

    .venv/bin/python benchmarks/grading.py [--real] [--repetitions N] [--only TABLE...]

Machines differ, so every table also has multiples of two yardsticks, which are measured again
before it: the start of a bare rclpy process, and a process that handles 3,449 poses.
`measuring.py` explains these, and what processor time and memory are here. No test reads any of
these numbers: they are for people.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import measuring
from measuring import ROOT, Cost, Group, load, median, ratio, row, spread

import grader
from grader import grading
from grader.exercise.loading import load_exercise
from grader.run import real_time, virtual_time
from grader.run.handover import Plan
from grader.run.processes import network
from grader.scenes.scene import Limits
from turtlesim_py.world.turtle import TICK_S

REFERENCE = ROOT / "turtlesim_challenge" / "turtle_controller.py"
#: Five ways to write a controller that students use, each for half a minute of simulated time.
STYLES = {
    "timer": "timer and rclpy.spin",
    "spin_once_loop": "loop of spin_once",
    "rate_with_spin_thread": "spin thread and rate.sleep",
    "sleeping_loop": "loop of time.sleep",
    "multi_threaded": "MultiThreadedExecutor, awaits",
}
PLAN = Plan(Limits(first_motion_s=5, rest_s=3, total_s=120))
PHASES = ("start", "discovery", "ticking", "shutdown")
AT_ONCE = (1, 2, 4)
#: The share of a processor in the smallest container of Gradescope.
HALF = 0.5
TABLES = ("runs", "casts", "commands", "rates", "half")
#: Nodes beside a cast: exercises of which the official solution is run.
TUTORIALS = ("talker", "service_server", "action_server", "qos")
#: What `grader run --watch` prints when it has graded.
GRADED = "Waiting for the next save"
#: Between two readings of the processor time of a run, to divide it among its phases [s].
READ_S = 0.005


# Work in a separate process. Each returns when its parts began and ended [s, monotonic] -------


def virtual_run(path: Path) -> tuple[list[float], int]:
    """Run a submission once in virtual time; also return the ticks."""
    with grader.open_submission(path) as submission:
        marks: dict[str, float] = {}
        begun = time.monotonic()
        recording = virtual_time.run(submission, PLAN, marks=marks)
        ended = time.monotonic()
    if recording.run.time != "virtual":
        raise RuntimeError(f"{path.stem}: {recording.run.flags}")
    return [begun, marks["met"], marks["connected"], marks["over"], ended], recording.run.ticks


def cast_run(path: Path, exercise: str) -> tuple[list[float], int]:
    """Run the usual case of an exercise with a cast once; also return the ticks."""
    with grader.open_submission(path) as submission:
        plan, *_ = grading.plan(submission, load_exercise(exercise))
        begun = time.monotonic()
        recording = virtual_time.run(submission, plan)
        return [begun, time.monotonic()], recording.run.ticks


def cast_grading(path: Path, exercise: str) -> tuple[list[float], float]:
    """Grade a submission with all its cases; also return the score."""
    begun = time.monotonic()
    score = grader.grade(path, exercise).score
    return [begun, time.monotonic()], score


def real_run(path: Path) -> tuple[list[float], int]:
    """Run a submission once in real time; also return the ticks."""
    with grader.open_submission(path) as submission:
        begun = time.monotonic()
        recording = real_time.run(submission, PLAN)
        return [begun, time.monotonic()], recording.run.ticks


def gradings(path: Path, at_once: int) -> tuple[list[float], list[float]]:
    """Grade a submission as many times at once, all its runs each; also return the scores."""
    begun = time.monotonic()
    with ThreadPoolExecutor(at_once) as pool:
        scores = [result.score for result in pool.map(grader.grade, [path] * at_once)]
    return [begun, time.monotonic()], scores


# Measuring that work ------------------------------------------------------------------------------


class CpuReadings:
    """Samples a group's processor time: how much was used between two times."""

    def __init__(self, measured: Group) -> None:
        self._measured = measured
        self._readings: list[tuple[float, float]] = []
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._read_on, daemon=True)

    def __enter__(self) -> CpuReadings:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._done.set()
        self._thread.join()

    def between(self, begin_s: float, end_s: float) -> Cost:
        """Return the cost between two times of the monotonic clock [s]."""
        has_any = len(self._readings) > 1
        return Cost(end_s - begin_s, self._at(end_s) - self._at(begin_s) if has_any else None)

    def _at(self, when_s: float) -> float:
        """Interpolate between the readings before and after."""
        readings = self._readings
        after = next((n for n, (at, _) in enumerate(readings) if at >= when_s), len(readings) - 1)
        (t0, cpu0), (t1, cpu1) = readings[max(after - 1, 0)], readings[after]
        return cpu1 if t1 <= t0 else cpu0 + (cpu1 - cpu0) * min((when_s - t0) / (t1 - t0), 1.0)

    def _read_on(self) -> None:
        while (used := self._measured.cpu_s()) is not None:
            self._readings.append((time.monotonic(), used))
            if self._done.is_set():  # one more after the end
                return
            self._done.wait(READ_S)


class Worker:
    """A process in a group, which does one job after the other."""

    def __init__(self, measured: Group, pool: ProcessPoolExecutor) -> None:
        self.group, self._pool = measured, pool

    def do(
        self, work: Callable[..., tuple[list[float], Any]], *arguments: object, times: int = 1
    ) -> list[tuple[Cost, list[Cost], Any]]:
        """Repeat the work; return each time the whole, its parts, and the work's other result."""
        with CpuReadings(self.group) as watch:
            answers = [self._pool.submit(work, *arguments).result() for _ in range(times)]
        return [
            (watch.between(edges[0], edges[-1]), [watch.between(*p) for p in pairwise(edges)], more)
            for edges, more in answers
        ]


@contextmanager
def worker(cpus: float | None = None) -> Iterator[Worker]:
    """Start a worker for some jobs."""
    spawn = multiprocessing.get_context("spawn")
    with measuring.group(cpus) as measured, ProcessPoolExecutor(1, spawn) as pool:
        with measured.entered():
            pool.submit(os.getpid).result()  # starts it
        yield Worker(measured, pool)


def warm_runs(
    path: Path, repetitions: int, cpus: float | None = None
) -> tuple[list[tuple[Cost, list[Cost], Any]], float | None]:
    """Run a submission again and again in one process; also return the peak [MiB]."""
    with worker(cpus) as at_work:
        at_work.do(virtual_run, path)
        return at_work.do(virtual_run, path, times=repetitions), at_work.group.peak_mib()


def command_cold(repetitions: int, cpus: float | None = None) -> list[Cost]:
    """Measure `grader run` of the reference, each in a fresh process, everything written."""
    with tempfile.TemporaryDirectory() as folder:
        words = [sys.executable, "-m", "grader", "run", str(REFERENCE), "--out", folder]
        return [measuring.command(words, cpus=cpus) for _ in range(repetitions)]


def command_warm(repetitions: int) -> list[Cost]:
    """Measure later verdicts of `grader run --watch`, from save to verdict."""
    samples = []
    with tempfile.TemporaryDirectory() as folder, measuring.group() as measured:
        path = Path(folder) / "turtle_controller.py"
        path.write_bytes(REFERENCE.read_bytes())
        words = [sys.executable, "-m", "grader", "run", str(path), "--watch"]
        words += ["--out", f"{folder}/graded"]
        with measured.entered():
            process = subprocess.Popen(
                words, cwd=ROOT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
            )
        assert process.stderr
        for number in range(repetitions + 1):
            with CpuReadings(measured) as watch:
                begun = time.monotonic()
                if number:
                    path.write_bytes(REFERENCE.read_bytes() + b"# saved again\n" * number)
                if not any(line.startswith(GRADED) for line in process.stderr):
                    raise SystemExit("grader run --watch ended")
                ended = time.monotonic()
            if number:
                samples.append(replace(watch.between(begun, ended), peak_mib=measured.peak_mib()))
        process.send_signal(signal.SIGINT)
        with suppress(subprocess.TimeoutExpired):
            process.wait(10)
        process.stderr.close()
    return samples


# Tables -------------------------------------------------------------------------------------------


class Units:
    """Both yardsticks, measured at the beginning of a table."""

    def __init__(
        self, env: dict[str, str], repetitions: int, *titles: str, cpus: float | None = None
    ) -> None:
        starts, floors = measuring.yardsticks(env, repetitions, cpus)
        self._units = (median(starts), median(floors))
        measured = ("", "wall [s]", "CPU [s]", "in starts (wall / CPU)", "in floors (wall / CPU)")
        measuring.head(*measured, *titles)
        self.row("start: a bare rclpy process", starts, *[""] * len(titles))
        self.row("floor: 3,449 poses", floors, *[""] * len(titles))

    def row(self, name: str, samples: Sequence[Cost], *more: object) -> None:
        """Print costs: wall, CPU, both as multiples of both yardsticks."""
        multiples = [ratio(median(samples), unit) for unit in self._units]
        wall, cpu = spread(s.wall_s for s in samples), spread(s.cpu_s for s in samples)
        row(name, wall, cpu, *multiples, *more)


def table_of_runs(env: dict[str, str], repetitions: int, with_real: bool) -> None:
    """Print the costs of a run of the reference and of each style."""
    print("\n## One run, warm: wall and CPU, and the stages of each (wall / CPU)")
    titles = ("simulated [s]", *PHASES, "peak of the process and its runs [MiB]")
    units = Units(env, 3, *titles, *["real time [s]"] * with_real)
    paths = {"reference": REFERENCE}
    for name, text in STYLES.items():
        paths[text] = ROOT / "tests" / "submissions" / "styles" / f"{name}.py"
    for name, path in paths.items():
        runs, peak_mib = warm_runs(path, repetitions)
        phases = [median(samples) for samples in zip(*(parts for _, parts, _ in runs), strict=True)]
        split = [f"{spread([s.wall_s], 3)} / {spread([s.cpu_s], 3)}" for s in phases]
        cells = [f"{runs[0][2] * TICK_S:.1f}", *split, spread([peak_mib], 0)]
        if with_real:
            with worker() as at_work:
                cells += [f"{at_work.do(real_run, path)[0][0].wall_s:.1f}"]
        units.row(name, [whole for whole, *_ in runs], *cells)


def table_of_casts(env: dict[str, str], repetitions: int) -> None:
    """Print what a node beside a cast costs, between two measurements of the yardsticks."""
    print("\n## A node beside a cast, warm")
    units = Units(env, 3)
    for name in TUTORIALS:
        path = ROOT / "tests" / "submissions" / "tutorials" / name / "right" / "official.py"
        for what, work in (("run of the usual case", cast_run), ("grading", cast_grading)):
            with worker() as at_work:
                at_work.do(work, path, name)
                done = at_work.do(work, path, name, times=repetitions)
            units.row(f"{name}: {what}", [whole for whole, *_ in done])
    Units(env, 3)


def table_of_commands(env: dict[str, str], repetitions: int) -> None:
    """Print the costs of `grader run`, cold and warm."""
    print("\n## `grader run` of the reference: three runs, everything written")
    units = Units(env, 3, "peak [MiB]")
    for name, samples in (
        ("cold: a fresh process", command_cold(repetitions)),
        ("warm: `--watch`, from a save to its verdict", command_warm(repetitions)),
    ):
        units.row(name, samples, spread((s.peak_mib for s in samples), 0))


def table_of_rates(env: dict[str, str], repetitions: int) -> None:
    """Print the costs of whole gradings in one process, one and several at once."""
    print("\n## Gradings of the reference (three runs each) in one warm process; a row's time is")
    print("that of one grading: the wall time of all divided by their number")
    units = Units(env, 3, "gradings a minute", "peak [MiB]")
    for at_once in AT_ONCE:
        with worker() as at_work:
            at_work.do(gradings, REFERENCE, at_once)
            jobs = at_work.do(gradings, REFERENCE, at_once, times=repetitions)
            peak_mib = at_work.group.peak_mib()
        each = [
            Cost(s.wall_s / at_once, None if s.cpu_s is None else s.cpu_s / at_once)
            for s, *_ in jobs
        ]
        rates = spread((60 / sample.wall_s for sample in each), 0)
        units.row(f"{at_once} at once", each, rates, spread([peak_mib], 0))


def table_at_half(env: dict[str, str]) -> None:
    """Print the costs of the reference on half a processor."""
    with measuring.group(HALF) as tried:
        neighbour = "a busy neighbour on the one core it may use"
        how = "cgroup quota" if tried.core is None else neighbour
    print(f"\n## The reference on half a processor ({how})")
    units = Units(env, 2, cpus=HALF)
    units.row("one run, warm", [whole for whole, *_ in warm_runs(REFERENCE, 2, HALF)[0]])
    units.row("`grader run`, cold", command_cold(2, HALF))


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--real", action="store_true", help="runs in real time too: 4 minutes more")
    parser.add_argument("--repetitions", type=int, default=5, help="of each figure: %(default)s")
    parser.add_argument("--only", nargs="+", choices=TABLES, default=TABLES, help="some tables")
    options = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # no group is left behind
    begun = time.monotonic()
    print(measuring.machine())
    print("Medians (lowest-highest). CPU: user and system time of all processes.")
    few = max(2, options.repetitions - 2)  # of slow figures
    with network.reserve_domain() as number:
        discovery = {"ROS_DOMAIN_ID": str(number), "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
        env = os.environ | discovery
        if "runs" in options.only:
            table_of_runs(env, options.repetitions, options.real)
        if "casts" in options.only:
            table_of_casts(env, options.repetitions)
        if "commands" in options.only:
            table_of_commands(env, few)
        if "rates" in options.only:
            table_of_rates(env, few)
        if "half" in options.only:
            table_at_half(env)
    print(f"\nTook {time.monotonic() - begun:.0f} s; load after (1, 5, 15 minutes) {load()}")


if __name__ == "__main__":
    main()
