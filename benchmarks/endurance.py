"""Test whether the grader endures many gradings, and kill -9 at random moments.

    .venv/bin/python benchmarks/endurance.py [--gradings N] [--seed N] [--kills SHARE] [--busy N]

One grader process (`grader.grade`, as a course's service would call it) grades right, wrong and
hostile fixtures in an order that the seed decides. Now and then the grader itself, a simulator or a
fork server is killed in the middle of it. A grading whose grader was killed is done again; any
other must have the verdict and the trace that it had at the beginning, when nothing was killed;
so must it while so many `--busy` processes use all the processor they get. After each it
counts memory and descriptors of the grader, its processes, the files below its temporary folder,
and shared memory. Exit code 1 if a verdict differed, if something was left behind, or if a figure
grew.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import random
import statistics
import subprocess
import sys
import tempfile
import threading
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

import psutil
from measuring import ROOT, head, row

import grader

SUBMISSIONS = ROOT / "tests" / "submissions"
FIXTURES = [
    ROOT / "turtlesim_challenge" / "turtle_controller.py",
    *(SUBMISSIONS / f"{name}.py" for name in (
        "quick_spiral", "square_controller", "styles/timer", "styles/multi_threaded",
        "services/all_services", "messages/many_calls", "misbehaving/raises_in_callback",
        "misbehaving/exits", "misbehaving/kills_itself", "misbehaving/never_spins",
        "misbehaving/attacks_link", "misbehaving/prints_a_million",
        "hostile_rubric/dead_reckoning", "hostile_rubric/pirouettes", "hostile_rubric/one_command",
        "hostile_rubric/pen_up",
    )),
]  # fmt: skip
#: Ends by itself where this process has gone, however that ended.
BUSY = "import os, sys\nwhile os.getppid() == int(sys.argv[1]):\n    for _ in range(100_000): pass"
VICTIMS = ("grader", "simulator", "fork server")
#: The range of the delay of a kill [s]; a grading takes about as long.
MOMENTS_S = (0.0, 2.0)
#: All processes of a killed grader must end within this time [s].
GONE_S = 20.0
#: How much a figure may grow from the first quarter of the gradings to the last: a share, and an
#: amount for chance.
GROWTH = {
    "memory of the grader [MB]": (0.2, 20.0),
    "its descriptors": (0.0, 3.0),
    "its threads": (0.0, 1.0),
    "its processes": (0.0, 1.0),
    "temporary files": (0.0, 3.0),
    "shared memory": (0.0, 10.0),
}


def scores(path: Path) -> dict[str, Any]:
    """Grade in the grader's process; return what must be the same each time."""
    try:
        result = grader.grade(path)
    except grader.GraderError as error:
        return {"error": (type(error).__name__, str(error.message))}
    runs = [run.trace_sha256 for run in (result.run, *result.varied_runs)]
    return {"runs": runs} | {each.check: (each.status, each.score) for each in result.verdicts}


class Grader:
    """The process that grades; restarted when it was killed."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        os.environ["TMPDIR"] = str(folder)  # for that process
        self.start()

    def start(self) -> None:
        """Start it."""
        self._pool = ProcessPoolExecutor(1, multiprocessing.get_context("spawn"))
        self.process = psutil.Process(self._pool.submit(os.getpid).result())

    def grade(self, path: Path) -> dict[str, Any] | None:
        """Return the scores of a submission; None if the process died."""
        try:
            return self._pool.submit(scores, path).result()
        except BrokenProcessPool:
            self._pool.shutdown()
            self.start()
            return None

    def figures(self) -> dict[str, float]:
        """Return its figures; call this only while nothing is being graded."""
        return {
            "memory of the grader [MB]": self.process.memory_info().rss / 2**20,
            "its descriptors": self.process.num_fds(),
            "its threads": self.process.num_threads(),
            "its processes": len(self.process.children(recursive=True)),
            "temporary files": sum(1 for _ in self._folder.rglob("*")),
            "shared memory": sum(1 for _ in Path("/dev/shm").iterdir()),
        }

    def end(self) -> None:
        """Kill it."""
        self.process.kill()
        self._pool.shutdown()


class Killer:
    """Kills a process of a grader after a delay.

    Attributes:
        seen: the grader's descendants at that moment.
        hit: what was killed; '' if there was no such process.
    """

    def __init__(
        self, process: psutil.Process, victim: str, delay_s: float, chance: random.Random
    ) -> None:
        self.seen: list[psutil.Process] = []
        self.hit = ""
        self._grader, self._victim, self._chance = process, victim, chance
        self._timer = threading.Timer(delay_s, self._strike)
        self._timer.start()

    def join(self) -> None:
        """Cancel the kill, unless it has begun."""
        self._timer.cancel()
        self._timer.join()

    def _strike(self) -> None:
        nearest = self._grader.children()
        self.seen = self._grader.children(recursive=True)
        # not a submission's supervisor: its death counts as the submission's
        servers = [process for process in nearest if "virtual_main" in _command(process)]
        simulators = [
            process
            for process in self.seen
            if process not in nearest and "simulator.virtual_main" in _command(process)
        ]
        victims = {
            "grader": [self._grader],
            "simulator": simulators,
            "fork server": servers,
        }[self._victim]
        if victims:
            with suppress(psutil.NoSuchProcess):
                self._chance.choice(victims).kill()
                self.hit = self._victim


def _command(process: psutil.Process) -> str:
    try:
        return " ".join(process.cmdline())
    except psutil.NoSuchProcess:
        return ""


def endure(gradings: int, seed: int, kills: float, folder: Path) -> list[str]:
    """Grade and kill; return what was not as it should be."""
    chance = random.Random(seed)
    at_work = Grader(folder)
    expected = {path: at_work.grade(path) for path in FIXTURES}
    samples = [at_work.figures()]
    struck: Counter[str] = Counter()
    wrong: list[str] = []
    for number in range(gradings):
        path = chance.choice(FIXTURES)
        killer = None
        if chance.random() < kills:
            delay_s = chance.uniform(*MOMENTS_S)
            killer = Killer(at_work.process, chance.choice(VICTIMS), delay_s, chance)
        found = at_work.grade(path)
        if killer:
            killer.join()
            struck[killer.hit or "none was there any more"] += 1
        if found is None and killer and killer.hit == "grader":
            _, left = psutil.wait_procs(killer.seen, GONE_S)
            wrong += [f"{number}: left of a killed grader: {each}" for each in left]
            found = at_work.grade(path)
        if found != expected[path]:
            by = f", {killer.hit} killed" if killer and killer.hit else ""
            wrong.append(f"{number}: {path.name}{by}: {found}, expected {expected[path]}")
        samples.append(at_work.figures())
        if (number + 1) % 50 == 0:
            print(f"{number + 1} of {gradings} gradings, {len(wrong)} deviations", flush=True)
    at_work.end()
    print(f"\nKilled: {dict(struck)}\n")
    return wrong + list(grown(samples))


def grown(samples: list[dict[str, float]]) -> list[str]:
    """Print every figure; return those that have grown."""
    found = []
    quarter = max(1, len(samples) // 4)
    head("figure", "first", "median", "last", "max")
    for name, (share, chance) in GROWTH.items():
        values = [sample[name] for sample in samples]
        middle = statistics.median(values)
        row(name, *(f"{value:.0f}" for value in (values[0], middle, values[-1], max(values))))
        before, after = (statistics.median(v) for v in (values[:quarter], values[-quarter:]))
        if after > before * (1 + share) + chance:
            found.append(f"{name} has grown from {before:.0f} to {after:.0f}")
    return found


def main() -> int:
    """Run the test; 1 if anything was not as it should be."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--gradings", type=int, default=500)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kills", type=float, default=0.3, help="in so many of the gradings")
    parser.add_argument("--busy", type=int, default=0, help="so many busy processes beside it")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="endurance-") as folder, ExitStack() as beside:
        for _ in range(args.busy):
            words = [sys.executable, "-c", BUSY, str(os.getpid())]
            beside.callback(subprocess.Popen(words).kill)
        wrong = endure(args.gradings, args.seed, args.kills, Path(folder))
    for line in wrong:
        print(line)
    print("All was as it should be." if not wrong else f"{len(wrong)} deviations.")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main())
