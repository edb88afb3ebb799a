"""What a grading costs: prints tables in Markdown, takes some two minutes.

    .venv/bin/python benchmarks/grading.py [--real] [--repetitions N] [--only TABLE...]

Machines differ, so everything is given as multiples of two yardsticks too, which are measured again
before each table: `yardsticks.py` says which. `measuring.py` says what processor time and memory
are here. No test looks at any of these numbers: they are for people.
"""

from __future__ import annotations

import argparse
import os
import signal
import sys
import time

import measuring
import yardsticks
from measuring import ROOT, Sample, spread
from timing import REFERENCE, command_cold, command_warm, real_s, runs_of, worker
from yardsticks import Yardsticks, middle

sys.path.insert(0, str(ROOT))  # this checkout, whatever is installed

from grader.run.processes import domain

#: Five ways to write a controller that students use, each for half a minute of simulated time.
STYLES = {
    "timer": "timer and rclpy.spin",
    "spin_once_loop": "loop of spin_once",
    "rate_with_spin_thread": "spin thread and rate.sleep",
    "sleeping_loop": "loop of time.sleep",
    "multi_threaded": "MultiThreadedExecutor, awaits",
}
STAGES = ("start", "discovery", "ticking", "shutdown")
AT_ONCE = (1, 2, 4)
#: Of a processor, as the smallest container of Gradescope has.
HALF = 0.5
TABLES = ("runs", "commands", "rates", "half")


def line(*cells: object) -> None:
    """A row of a Markdown table."""
    print("| " + " | ".join(str(cell) for cell in cells) + " |", flush=True)


def head(*cells: str) -> None:
    """The first row of a Markdown table, and the one below it."""
    print()
    line(*cells)
    print("|---" + "|--:" * (len(cells) - 1) + "|")


def row(name: str, samples: list[Sample], units: Yardsticks, *more: object) -> None:
    """What something took: wall, CPU, both as multiples of both yardsticks."""
    wall, cpu = [s.wall_s for s in samples], [s.cpu_s for s in samples]
    typical = middle(samples)
    multiples = units.multiples(typical.wall_s, typical.cpu_s)
    line(name, spread(wall), spread(cpu), *multiples, *more)


def mebibytes(peak: float | None) -> str:
    """A peak of memory in a cell."""
    return "-" if peak is None else f"{peak:.0f}"


def yardstick_rows(
    env: dict[str, str], repetitions: int, more: tuple[str, ...] = (), cpus: float | None = None
) -> Yardsticks:
    """Measure the yardsticks, and begin a table with them."""
    units, starts, floors = yardsticks.measure(env, repetitions, cpus)
    head("", "wall [s]", "CPU [s]", "in starts (wall / CPU)", "in floors (wall / CPU)", *more)
    for name, samples in (("start: a bare rclpy process", starts), ("floor: 3,449 poses", floors)):
        row(name, samples, units, *[""] * len(more))
    return units


def table_of_runs(env: dict[str, str], repetitions: int, with_real: bool) -> None:
    """The reference and the styles, a run each."""
    print("\n## One run, warm: wall and CPU, and the stages of each (wall / CPU)")
    more = ("simulated [s]", *STAGES, "peak of the process and its runs [MiB]")
    units = yardstick_rows(env, 3, (*more, "real time [s]") if with_real else more)
    paths = {"reference": REFERENCE}
    paths |= {
        text: ROOT / "tests" / "submissions" / "styles" / f"{name}.py"
        for name, text in STYLES.items()
    }
    for name, path in paths.items():
        runs, peak = runs_of(path, repetitions)
        stages = [middle([run.stages[n] for run in runs]) for n in range(len(STAGES))]
        split = [
            f"{s.wall_s:.3f} / " + ("-" if s.cpu_s is None else f"{s.cpu_s:.3f}") for s in stages
        ]
        shown = [f"{runs[0].simulated_s:.1f}", *split, mebibytes(peak)]
        real = [f"{real_s(path):.1f}"] if with_real else []
        row(name, [run.whole for run in runs], units, *shown, *real)


def table_of_commands(env: dict[str, str], repetitions: int) -> None:
    """`grader run`, cold and warm."""
    print("\n## `grader run` of the reference: three runs, everything written")
    units = yardstick_rows(env, 3, ("peak [MiB]",))
    for name, samples in (
        ("cold: a fresh process", command_cold(repetitions)),
        ("warm: `--watch`, from a save to its verdict", command_warm(repetitions)),
    ):
        row(name, samples, units, spread((s.peak_mib for s in samples), 0))


def table_of_rates(env: dict[str, str], repetitions: int) -> None:
    """Whole gradings in one process, one and several at once."""
    print("\n## Gradings of the reference (three runs each) in one warm process; a row's time is")
    print("that of one grading: the wall time of all divided by their number")
    units = yardstick_rows(env, 3, ("gradings a minute", "peak [MiB]"))
    for at_once in AT_ONCE:
        with worker("gradings", at_once, REFERENCE) as at_work:
            at_work.do()
            jobs = [at_work.do()[0] for _ in range(repetitions)]
            peak = at_work.group.peak_mib()
        each = [
            Sample(s.wall_s / at_once, None if s.cpu_s is None else s.cpu_s / at_once) for s in jobs
        ]
        rates = spread((60 / sample.wall_s for sample in each), 0)
        row(f"{at_once} at once", each, units, rates, mebibytes(peak))


def table_at_half(env: dict[str, str], repetitions: int) -> None:
    """The same on half a processor."""
    print(f"\n## The reference on half a processor ({measuring.how_limited(HALF)})")
    units = yardstick_rows(env, 2, cpus=HALF)
    row("one run, warm", [r.whole for r in runs_of(REFERENCE, repetitions, HALF)[0]], units)
    row("`grader run`, cold", command_cold(repetitions, HALF), units)


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
    few = max(2, options.repetitions - 2)  # of what takes longer
    with domain.reserve_domain() as number:
        env = os.environ | {
            "ROS_DOMAIN_ID": str(number),
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        }
        if "runs" in options.only:
            table_of_runs(env, options.repetitions, options.real)
        if "commands" in options.only:
            table_of_commands(env, few)
        if "rates" in options.only:
            table_of_rates(env, few)
        if "half" in options.only:
            table_at_half(env, 2)
    load = " ".join(f"{value:.1f}" for value in os.getloadavg())
    print(f"\nTook {time.monotonic() - begun:.0f} s; load after (1, 5, 15 minutes) {load}")


if __name__ == "__main__":
    main()
