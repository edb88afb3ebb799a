"""Measure what a class costs: `grader batch` for 1, 2, 4 jobs.

    .venv/bin/python benchmarks/class.py [--count N] [--jobs 1 2 4] [--seed N]

A class made of the fixtures (scripts/make_class.py) is graded anew for each number of jobs. It
prints gradings a minute, CPU seconds a grading and the peak of memory, all processes together; and
the cost of 1,000 and 100,000 submissions.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

from measuring import ROOT, command, head, machine, row, spread

HOUR_S = 3600.0


def batch(submissions: Path, out: Path, jobs: int) -> list[str]:
    """Return the call of `grader batch`."""
    words = [sys.executable, "-m", "grader", "batch", str(submissions), "--out", str(out)]
    return [*words, "--jobs", str(jobs)]


def measure(submissions: Path, folder: Path, count: int, jobs: list[int]) -> None:
    """Print the table."""
    head("jobs", "wall [s]", "gradings a minute", "CPU a grading [s]", "peak memory [MiB]")
    samples = []
    for number in jobs:
        sample = command(batch(submissions, folder / f"out{number}", number))
        samples.append(sample.cpu_s / count if sample.cpu_s is not None else None)
        rate = f"{count / sample.wall_s * 60:.0f}"
        peak = spread([sample.peak_mib], 0)
        row(number, f"{sample.wall_s:.0f}", rate, spread(samples[-1:]), peak)
    if cpu_s := [sample for sample in samples if sample is not None]:
        for many in (1_000, 100_000):
            print(f"{many:,} submissions: {many * min(cpu_s) / HOUR_S:.1f} core hours")


def main() -> None:
    """Make a class, and measure."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--jobs", type=int, nargs="+", default=[1, 2, 4])
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    print(machine())
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        submissions = folder / "class"
        make = [sys.executable, str(ROOT / "scripts" / "make_class.py"), str(submissions)]
        subprocess.run([*make, "--count", str(args.count), "--seed", str(args.seed)], check=True)
        measure(submissions, folder, args.count, args.jobs)


if __name__ == "__main__":
    main()
