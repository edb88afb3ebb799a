"""Calls of this checkout's programs, as benchmarks measure them."""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # whatever is installed


@dataclass(frozen=True)
class Cost:
    """The cost of a call.

    Attributes:
        wall_s: from its start to its end [s].
        cpu_s: user and system time of all its processes that were waited for [s].
    """

    wall_s: float
    cpu_s: float


def grader_call(*words: str | Path) -> Cost:
    """Call `grader` with these words and a new folder for `--out`."""
    command = [sys.executable, "-m", "grader", *words]
    with tempfile.TemporaryDirectory() as out:
        start_s, start_cpu_s = time.perf_counter(), _children_cpu_s()
        subprocess.run(
            [*command, "--out", out],
            cwd=ROOT,
            check=True,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        return Cost(time.perf_counter() - start_s, _children_cpu_s() - start_cpu_s)


def _children_cpu_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
