"""What grading costs in real and in virtual time: prints two tables, takes about five minutes.

    .venv/bin/python benchmarks/grading.py [--no-real] [--repetitions N]

Five ways to write a controller that students use, of which each drives for half a minute of
simulated time. No test looks at any of these numbers: they are for people.
"""

from __future__ import annotations

import argparse
import os
import platform
import statistics
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # this checkout, whatever is installed

from grader.run import real_time, virtual_time  # noqa: E402
from grader.run.plan import Plan  # noqa: E402
from grader.scenes.scene import Limits  # noqa: E402
from grader.submission.opening import open_submission  # noqa: E402

STYLES = {
    "timer": "timer and rclpy.spin",
    "spin_once_loop": "loop of spin_once",
    "rate_with_spin_thread": "spin thread and rate.sleep",
    "sleeping_loop": "loop of time.sleep",
    "multi_threaded": "MultiThreadedExecutor, awaits",
}
REFERENCE = ROOT / "turtlesim_challenge" / "turtle_controller.py"
PLAN = Plan(Limits(first_motion_s=5, rest_s=3, total_s=120))
AT_ONCE = (1, 2, 4)


@dataclass(frozen=True)
class Timing:
    """One run [s]."""

    simulated: float
    whole: float
    start: float = 0.0
    discovery: float = 0.0
    ticking: float = 0.0
    shutdown: float = 0.0


def style(name: str) -> Path:
    """The submission of this style."""
    return ROOT / "tests" / "submissions" / "styles" / f"{name}.py"


def virtual(path: Path) -> Timing:
    """Grade once in virtual time."""
    marks: dict[str, float] = {}
    with open_submission(path) as submission:
        begun = time.monotonic()
        recording = virtual_time.run(submission, PLAN, marks=marks)
        ended = time.monotonic()
    if recording.run.time != "virtual":
        raise SystemExit(f"{path.stem}: {recording.run.flags}")
    stages = (begun, marks["met"], marks["connected"], marks["over"], ended)
    parts = (after - before for before, after in pairwise(stages))
    return Timing(recording.run.ticks * 0.016, ended - begun, *parts)


def real(path: Path) -> float:
    """Grade once in real time; the wall time [s]."""
    with open_submission(path) as submission:
        begun = time.monotonic()
        real_time.run(submission, PLAN)
        return time.monotonic() - begun


def row(name: str, runs: list[Timing], real_s: float | None) -> str:
    """One line of the first table."""
    whole = [run.whole for run in runs]
    parts = ("start", "discovery", "ticking", "shutdown")
    medians = (statistics.median(getattr(run, part) for run in runs) for part in parts)
    shown = f"{real_s:8.1f}" if real_s is not None else f"{'-':>8}"
    return (
        f"{name:31}{runs[0].simulated:9.1f}{shown}{statistics.median(whole):9.2f}"
        f"  ({min(whole):.2f}-{max(whole):.2f})" + "".join(f"{s:10.2f}" for s in medians)
    )


def a_minute(at_once: int, repetitions: int) -> float:
    """How many runs of the reference end in a minute."""
    count = at_once * repetitions
    begun = time.monotonic()
    with ThreadPoolExecutor(at_once) as pool:
        list(pool.map(virtual, [REFERENCE] * count))
    return 60 * count / (time.monotonic() - begun)


def machine() -> str:
    """What this runs on."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    model = next((line.partition(":")[2].strip() for line in lines if "model name" in line), "?")
    load = os.getloadavg()[0]
    return f"{model}, {os.cpu_count()} cores, load {load:.1f}, Python {platform.python_version()}"


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--no-real", action="store_true", help="leave real time out: one minute")
    parser.add_argument("--repetitions", type=int, default=5, help="of each figure: %(default)s")
    options = parser.parse_args()
    print(machine(), end="\n\n")
    print(f"{'seconds':31}{'simulated':>9}{'real':>8}{'virtual':>9}  {'(spread)':11}", end="")
    print(f"{'start':>9}{'discovery':>10}{'ticking':>10}{'shutdown':>10}")
    paths = {"reference": REFERENCE, **{text: style(name) for name, text in STYLES.items()}}
    for name, path in paths.items():
        runs = [virtual(path) for _ in range(options.repetitions)]
        # the reference takes a minute in real time and is no style of its own
        real_s = None if options.no_real or path == REFERENCE else real(path)
        print(row(name, runs, real_s), flush=True)
    print("\ngradings of the reference a minute, median (spread)")
    for at_once in AT_ONCE:
        rates = [a_minute(at_once, 3) for _ in range(3)]
        low, high = min(rates), max(rates)
        print(f"{at_once} at once: {statistics.median(rates):6.0f}  ({low:.0f}-{high:.0f})")


if __name__ == "__main__":
    main()
