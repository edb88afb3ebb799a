"""Measure what a grading costs: tables in Markdown, in about two minutes.

    .venv/bin/python benchmarks/grading.py [--real] [--repetitions N] [--only TABLE...]

On a part of a processor: in a container with that quota, as `docker run --cpus 0.5`.

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
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path
from typing import Any

import measuring
from measuring import ROOT, Cost, Group, load, median, ratio, row, spread

import grader
from grader import grading
from grader.exercise import DEFAULT
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
AT_ONCE = (1, 2, 4)
TABLES = ("runs", "casts", "commands", "rates")
#: Nodes beside a cast: exercises of which the official solution is run.
TUTORIALS = ("talker", "service_server", "action_server", "qos")
#: What `grader run --watch` prints when it has graded.
GRADED = "Waiting for the next save"
#: Work in a group returns what it cost, and something more; `Do` repeats it in another process.
Work = Callable[..., tuple[Cost, Any]]
Do = Callable[..., list[tuple[Cost, Any]]]


# Work in a separate process, whose group comes first ----------------------------------------------


def virtual_run(own: Group, path: Path, exercise: str = "") -> tuple[Cost, int]:
    """Run a submission once in virtual time, by an exercise's usual case; also return ticks."""
    with grader.open_submission(path) as submission:
        plan = grading.plan(submission, load_exercise(exercise))[0] if exercise else PLAN
        begun = own.now()
        recording = virtual_time.run(submission, plan)
        cost = own.since(begun)
    if recording.run.time != "virtual":
        raise RuntimeError(f"{path.stem}: {recording.run.flags}")
    return cost, recording.run.ticks


def real_run(own: Group, path: Path) -> tuple[Cost, int]:
    """Run a submission once in real time; also return the ticks."""
    with grader.open_submission(path) as submission:
        begun = own.now()
        recording = real_time.run(submission, PLAN)
        return own.since(begun), recording.run.ticks


def gradings(own: Group, path: Path, exercise: str, at_once: int = 1) -> tuple[Cost, list[float]]:
    """Grade a submission as many times at once, all its runs each; also return the scores."""
    begun = own.now()
    with ThreadPoolExecutor(at_once) as pool:
        results = pool.map(grader.grade, [path] * at_once, [exercise] * at_once)
        scores = [result.score for result in results]
    return own.since(begun), scores


# Measuring that work ------------------------------------------------------------------------------


@contextmanager
def worker() -> Iterator[Do]:
    """Start a process in a group, which does one job after the other."""
    spawn = multiprocessing.get_context("spawn")
    with measuring.group() as own, ProcessPoolExecutor(1, spawn) as pool:
        with own.entered():
            pool.submit(os.getpid).result()  # starts it

        def do(work: Work, *arguments: object, times: int = 1) -> list[tuple[Cost, Any]]:
            return [pool.submit(work, own, *arguments).result() for _ in range(times)]

        yield do


def graded_once(env: dict[str, str], own: Group | None = None) -> tuple[Cost, float]:
    """Measure `grader run` of the reference, everything written; also when its first line came.

    Args:
        own: the group of servers that do it.
    """
    with tempfile.TemporaryDirectory() as folder, measuring.group() as measured:
        words = [sys.executable, "-P", "-m", "grader", "run", str(REFERENCE), "--out", folder]
        env = env | {"PYTHONPATH": str(ROOT)}
        begun, theirs = measured.now(), own.now() if own else None
        with measured.entered():
            process = subprocess.Popen(
                words, env=env, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
            )
        assert process.stdout is not None
        process.stdout.readline()
        first_s = time.monotonic() - begun.wall_s
        process.stdout.read()
        if process.wait():
            raise SystemExit("grader run failed")
        cost = measured.since(begun)
        if own and theirs:
            more = own.since(theirs).cpu_s
            both = None if cost.cpu_s is None or more is None else cost.cpu_s + more
            cost = Cost(cost.wall_s, both)
        return cost, first_s


@contextmanager
def servers(env: dict[str, str]) -> Iterator[Group]:
    """Start servers in a group, and stop them."""
    words = [sys.executable, "-P", "-m", "grader", "servers"]
    env = env | {"PYTHONPATH": str(ROOT)}
    with measuring.group() as own:
        with own.entered():
            subprocess.run([*words, "start"], env=env, check=True, stdout=subprocess.DEVNULL)
        yield own
        subprocess.run([*words, "stop"], env=env, check=True, stdout=subprocess.DEVNULL)


@contextmanager
def watching() -> Iterator[Callable[[], tuple[Cost, float]]]:
    """Start `grader run --watch`; each call saves, and measures up to the files of the verdict."""
    with tempfile.TemporaryDirectory() as folder, measuring.group() as measured:
        path = Path(folder) / "turtle_controller.py"
        path.write_bytes(REFERENCE.read_bytes())
        words = [sys.executable, "-P", "-m", "grader", "run", str(path), "--watch"]
        words += ["--out", f"{folder}/graded"]
        env = os.environ | {"PYTHONPATH": str(ROOT), "GRADER_SERVERS": "off"}
        with measured.entered():
            process = subprocess.Popen(
                words, env=env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
            )
        printed, said = process.stdout, process.stderr
        assert printed is not None and said is not None

        def verdict() -> tuple[Cost, float]:
            begun = measured.now()
            with path.open("ab") as file:
                file.write(b"# saved again\n")
            return waited(begun)

        def waited(begun: Cost) -> tuple[Cost, float]:
            os.read(printed.fileno(), 1 << 16)
            first_s = time.monotonic() - begun.wall_s
            if not any(line.startswith(GRADED) for line in said):
                raise SystemExit("grader run --watch ended")
            cost = measured.since(begun)
            os.set_blocking(printed.fileno(), False)
            with suppress(BlockingIOError):
                while os.read(printed.fileno(), 1 << 16):
                    pass
            os.set_blocking(printed.fileno(), True)
            return cost, first_s

        waited(measured.now())
        yield verdict
        process.send_signal(signal.SIGINT)
        with suppress(subprocess.TimeoutExpired):
            process.wait(10)


# Tables -------------------------------------------------------------------------------------------


class Units:
    """Both yardsticks, measured at the beginning of a table."""

    def __init__(self, env: dict[str, str], repetitions: int, *titles: str) -> None:
        starts, floors = measuring.yardsticks(env, repetitions)
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
    print("\n## One run, warm")
    titles = ("simulated [s]", "peak of the process and its runs [MiB]")
    units = Units(env, 3, *titles, *["real time [s]"] * with_real)
    paths = {"reference": REFERENCE}
    for name, text in STYLES.items():
        paths[text] = ROOT / "tests" / "submissions" / "styles" / f"{name}.py"
    for name, path in paths.items():
        with worker() as do:
            do(virtual_run, path)
            runs = do(virtual_run, path, times=repetitions)
        samples, ticks = [cost for cost, _ in runs], runs[0][1]
        cells = [f"{ticks * TICK_S:.1f}", spread([samples[-1].peak_mib], 0)]
        if with_real:
            with worker() as do:
                cells += [f"{do(real_run, path)[0][0].wall_s:.1f}"]
        units.row(name, samples, *cells)


def table_of_casts(env: dict[str, str], repetitions: int) -> None:
    """Print what a node beside a cast costs, between two measurements of the yardsticks."""
    print("\n## A node beside a cast, warm")
    units = Units(env, 3)
    for name in TUTORIALS:
        path = ROOT / "tests" / "submissions" / "tutorials" / name / "right" / "official.py"
        for what, work in (("run of the usual case", virtual_run), ("grading", gradings)):
            with worker() as do:
                do(work, path, name)
                done = do(work, path, name, times=repetitions)
            units.row(f"{name}: {what}", [cost for cost, _ in done])
    Units(env, 3)


def table_of_commands(env: dict[str, str], repetitions: int) -> None:
    """Print the costs of `grader run`, all in one series, in turns."""
    print("\n## `grader run` of the reference: four runs, 176 simulated s, everything written\n")
    off = os.environ | {"GRADER_SERVERS": "off"}

    def bare() -> tuple[Cost, float]:
        cost = measuring.bare(env)
        return cost, cost.wall_s

    with servers(dict(os.environ)) as own, watching() as verdict:
        samples = measuring.in_turns(
            repetitions,
            bare,
            partial(graded_once, off),
            partial(graded_once, dict(os.environ), own),
            verdict,
        )
    names = (
        "a bare rclpy process",
        "a fresh process",
        "with `grader servers`",
        "`--watch`: a save",
    )
    titles = ("first line [s]", "all files [s]", "CPU [s]", "in bare processes: first, all, CPU")
    measuring.head("", *titles)
    unit = median([cost for cost, _ in samples[0]])
    for name, found in zip(names, samples, strict=True):
        costs, firsts = [cost for cost, _ in found], [first_s for _, first_s in found]
        middle = median(costs)
        first = statistics.median(firsts) / unit.wall_s
        row(
            name,
            spread(firsts),
            spread(cost.wall_s for cost in costs),
            spread(cost.cpu_s for cost in costs),
            f"{first:.1f}, " + ratio(middle, unit).replace(" / ", ", "),
        )
    with tempfile.TemporaryDirectory() as folder:
        words = [sys.executable, "-P", "-m", "grader", "run", str(REFERENCE), "--out", folder]
        peak = measuring.peak_pss_mib(words, off | {"PYTHONPATH": str(ROOT)})
    print(f"\nMemory of all processes of a call at its peak (PSS): {peak:.0f} MiB")


def table_of_rates(env: dict[str, str], repetitions: int) -> None:
    """Print the costs of whole gradings in one process, one and several at once."""
    print("\n## Gradings of the reference (three runs each) in one warm process; a row's time is")
    print("that of one grading: the wall time of all divided by their number")
    units = Units(env, 3, "gradings a minute", "peak [MiB]")
    for at_once in AT_ONCE:
        with worker() as do:
            asked = (gradings, REFERENCE, DEFAULT, at_once)
            do(*asked)
            jobs = [cost for cost, _ in do(*asked, times=repetitions)]
        each = [
            Cost(s.wall_s / at_once, None if s.cpu_s is None else s.cpu_s / at_once) for s in jobs
        ]
        rates = spread((60 / sample.wall_s for sample in each), 0)
        units.row(f"{at_once} at once", each, rates, spread([jobs[-1].peak_mib], 0))


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
    print(f"\nTook {time.monotonic() - begun:.0f} s; load after (1, 5, 15 minutes) {load()}")


if __name__ == "__main__":
    main()
