"""Times what is graded: single runs, the whole command, several gradings at once."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import measuring
from measuring import ROOT, Sample

REFERENCE = ROOT / "turtlesim_challenge" / "turtle_controller.py"
#: What `grader run --watch` says when it has graded.
GRADED = "Waiting for the next save"


@dataclass(frozen=True)
class Run:
    """One run in virtual time: the whole, its stages, and how much was simulated [s]."""

    whole: Sample
    stages: tuple[Sample, ...]
    simulated_s: float


class Worker:
    """`work.py` in a group of its own, one job a line."""

    def __init__(self, ours: measuring.Group, *words: object) -> None:
        self.group = ours
        command = [sys.executable, str(ROOT / "benchmarks" / "work.py"), *map(str, words)]
        self._process = ours.start(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        assert self._process.stdin and self._process.stdout
        self._to, self._back = self._process.stdin, self._process.stdout
        self._answer()

    def do(self) -> tuple[Sample, Any]:
        """One job: what it took, and what it says."""
        cpu_s, begun = self.group.cpu_s(), time.monotonic()
        self._to.write("\n")
        self._to.flush()
        answer = self._answer()
        wall_s, after_s = time.monotonic() - begun, self.group.cpu_s()
        return Sample(wall_s, used(cpu_s, after_s)), answer

    def end(self) -> None:
        """Let it go as its input ends."""
        self._to.close()
        self._process.wait()
        self._back.close()

    def _answer(self) -> Any:
        line = self._back.readline()
        if not line:
            raise SystemExit("the measured process ended; it says above why")
        return json.loads(line)


@contextmanager
def worker(*words: object, cpus: float | None = None) -> Iterator[Worker]:
    """A worker for some jobs."""
    with measuring.group(cpus) as ours:
        made = Worker(ours, *words)
        try:
            yield made
        finally:
            made.end()


def runs_of(
    path: Path, repetitions: int, cpus: float | None = None
) -> tuple[list[Run], float | None]:
    """Warm runs of a submission, one after the other in one process; and the peak [MiB]."""
    made = []
    with worker("runs", path, cpus=cpus) as at_work:
        at_work.do()
        with measuring.Watch(at_work.group) as watch:
            jobs = [at_work.do() for _ in range(repetitions)]
        for whole, told in jobs:
            edges = told["edges"]
            stages = tuple(Sample(b - a, watch.between(a, b)) for a, b in pairwise(edges))
            made.append(Run(whole, stages, told["ticks"] * 0.016))
        return made, at_work.group.peak_mib()


def command_cold(repetitions: int, cpus: float | None = None) -> list[Sample]:
    """`grader run` of the reference, each in a fresh process, everything written."""
    with tempfile.TemporaryDirectory() as folder:
        words = [sys.executable, "-m", "grader", "run", str(REFERENCE), "--out", folder]
        return [measuring.command(words, cpus=cpus) for _ in range(repetitions)]


def command_warm(repetitions: int) -> list[Sample]:
    """The second verdict and those after it under `grader run --watch`, from save to verdict."""
    samples = []
    with tempfile.TemporaryDirectory() as folder, measuring.group() as ours:
        path = Path(folder) / "turtle_controller.py"
        path.write_bytes(REFERENCE.read_bytes())
        words = [sys.executable, "-m", "grader", "run", str(path), "--watch"]
        process = ours.start(
            [*words, "--out", f"{folder}/graded"],
            cwd=ROOT,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
        )
        assert process.stderr
        for number in range(repetitions + 1):
            cpu_s, begun = ours.cpu_s(), time.monotonic()
            if number:
                path.write_bytes(REFERENCE.read_bytes() + b"# saved again\n" * number)
            if not any(line.startswith(GRADED) for line in process.stderr):
                raise SystemExit("grader run --watch ended")
            wall_s, after_s = time.monotonic() - begun, ours.cpu_s()
            if number:
                samples.append(Sample(wall_s, used(cpu_s, after_s), ours.peak_mib()))
        process.send_signal(signal.SIGINT)
        with suppress(subprocess.TimeoutExpired):
            process.wait(10)
        process.stderr.close()
    return samples


def real_s(path: Path) -> float:
    """A run in real time [s]."""
    with worker("real", path) as at_work:
        return at_work.do()[0].wall_s


def used(before_s: float | None, after_s: float | None) -> float | None:
    """The processor time between two readings [s]."""
    return None if before_s is None or after_s is None else after_s - before_s
