"""What a grading costs: the reference controller, four runs of 176 simulated seconds in all.

    .venv/bin/python benchmarks/grading.py [--fast] [-o FILE.json]

Cold is `grader run`, everything written, in a process of its own. In fork servers is what the
second hand-in of a call costs, in `grader batch` as with `--watch`: all is imported already.
"""

from __future__ import annotations

import pyperf
from calls import ROOT, Cost, grader_call

import grader

REFERENCE = ROOT / "turtlesim_challenge" / "turtle_controller.py"


def cold() -> Cost:
    """Grade the reference in a call of its own."""
    return grader_call("run", REFERENCE)


def main() -> None:
    runner = pyperf.Runner(processes=3, values=3, warmups=1, loops=1)
    runner.bench_time_func("grading, cold", lambda _: cold().wall_s)
    runner.bench_time_func("grading, cold: CPU", lambda _: cold().cpu_s)
    runner.bench_func("grading, in the call's fork servers", grader.grade, REFERENCE)


if __name__ == "__main__":
    main()
