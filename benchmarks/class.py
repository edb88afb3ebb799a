"""What a class costs: `grader batch` for 1, 2, 4 jobs, and where the time goes.

    .venv/bin/python benchmarks/class.py [--count N] [--jobs 1 2 4] [--seed N]

A class made of the fixtures (scripts/make_class.py) is graded anew for each number of jobs. Prints
gradings a minute, CPU seconds a grading and the peak of memory, all processes together, and of one
hand-in at a time how long each step takes; then what 1,000 and 100,000 hand-ins come to.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from measuring import Sample, group, machine, spread

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from grader import grading, judging  # noqa: E402
from grader.batch.page.thumb import thumb  # noqa: E402
from grader.batch.similar import behaviour, sources  # noqa: E402
from grader.exercise.loading import load_exercise  # noqa: E402
from grader.reports import Report, render  # noqa: E402
from grader.run.processes import cores  # noqa: E402
from grader.submission.opening import open_submission  # noqa: E402

HOUR_S = 3600.0


def whole(submissions: Path, out: Path, jobs: int) -> Sample:
    """Grade a class in a process group of its own."""
    command = [sys.executable, "-m", "grader", "batch", str(submissions), "--out", str(out)]
    with group() as measured:
        began = time.perf_counter()
        process = measured.start(
            [*command, "--jobs", str(jobs)], cwd=ROOT, stderr=subprocess.DEVNULL
        )
        process.wait()
        wall_s = time.perf_counter() - began
        return Sample(wall_s, measured.cpu_s(), measured.peak_mib())


def steps(submissions: list[Path], folder: Path) -> dict[str, list[float]]:
    """Wall time of each step of a grading [s], one hand-in after the other."""
    exercise, run = load_exercise("turtlesim_challenge"), grading.RUNNERS["virtual"]
    found: dict[str, list[float]] = {}
    for number, path in enumerate(submissions):
        place = folder / str(number)
        place.mkdir()
        last = time.perf_counter()

        def took(step: str) -> None:
            nonlocal last
            now = time.perf_counter()
            found.setdefault(step, []).append(now - last)
            last = now

        with open_submission(path) as submission:
            took("read what was handed in")
            recordings = grading.run_all(submission, exercise, run)
            took("three runs")
            if submission.copy is not None:
                sources.keep(submission.copy.folder, place / sources.SOURCE)
            behaviour.behaved(place / sources.SOURCE, recordings.nominal)
            thumb(recordings)
            took("for the pages of the class")
        judging.save_recordings(recordings, place / "recording")
        took("write recordings")
        result = judging.judge(recordings, exercise, submission="x")
        took("judge")
        render("html", [Report.of(result, place, recordings, "whole")])
        took("report page")
        judging.judge(judging.load_recordings(place / "recording"), exercise)
        took("(a regrade: read and judge)")
    return found


def main() -> int:
    """Measure and print."""
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
        print("| jobs | wall [s] | gradings a minute | CPU a grading [s] | peak memory [MiB] |")
        print("|---:|---:|---:|---:|---:|")
        cpu_s: list[float] = []
        for jobs in args.jobs:
            took = whole(submissions, folder / f"out{jobs}", jobs)
            a_grading = None if took.cpu_s is None else took.cpu_s / args.count
            cpu_s += [] if a_grading is None else [a_grading]
            print(
                f"| {jobs} | {took.wall_s:.0f} | {args.count / took.wall_s * 60:.0f} | "
                f"{'-' if a_grading is None else f'{a_grading:.2f}'} | "
                f"{'-' if took.peak_mib is None else f'{took.peak_mib:.0f}'} |",
                flush=True,
            )
        for count in (1_000, 100_000) if cpu_s else ():
            print(f"{count:,} hand-ins: {count * min(cpu_s) / HOUR_S:.1f} core hours")
        usual = ROOT / "turtlesim_challenge" / "turtle_controller.py"
        few = folder / "steps"
        few.mkdir()
        steps([usual], folder)  # imports, and processes that wait for the next
        found = steps([usual] * 10, few)
    print(f"\nOne right solution at a time, {cores.share():g} cores, wall time [s]:")
    for step, values in found.items():
        print(f"| {step} | {spread(values, 3)} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
