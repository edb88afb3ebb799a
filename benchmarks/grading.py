"""What a grading costs: of the reference controller, and of a hand-in of a class.

    .venv/bin/python benchmarks/grading.py [--fast] [-o FILE.json]

Cold is `grader run`, everything written, in a process of its own: four runs of 176 simulated
seconds in all. In fork servers is what the second hand-in of a call costs, in `grader batch` as
with `--watch`: all is imported already. The class is `grader batch` of twenty hand-ins with two
jobs, the same each time: half of them are right or lack one thing (the challenge's solution and its
mutants), a third are beginners' mistakes, two are hostile, one is no program.
"""

from __future__ import annotations

import random
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import pyperf

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # whatever is installed

import grader  # noqa: E402
from grader.exercise.loading import load_exercise  # noqa: E402
from grader.testing.solutions import read_solutions  # noqa: E402
from tests.attacks.attacks import ATTACKS  # noqa: E402
from tests.hand_ins import SUBMISSIONS, read  # noqa: E402

REFERENCE = ROOT / "turtlesim_challenge" / "turtle_controller.py"
JOBS = 2
#: How many there are of a kind.
RIGHT, MISTAKEN, HOSTILE = 10, 7, ("imitates_results", "fakes_a_traceback")
NO_PROGRAM = "import rclpy\ndef main()\n    pass\n"


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


def programs() -> list[str]:
    """Return the texts that are handed in."""
    chance = random.Random(1)
    right = [each.text() for each in read_solutions(load_exercise("turtlesim_challenge"))]
    # except those that use a minute of a processor each
    mistakes = [
        name
        for name, row in sorted(read("first_lines").items())
        if {"says", "replace"} <= set(row) and not name.startswith(("loops", "floods"))
    ]
    texts = SUBMISSIONS / "first_lines"
    return [
        *(right[0] for _ in range(RIGHT // 2)),
        *chance.sample(right, RIGHT - RIGHT // 2),
        *(
            (texts / f"{name}.py").read_text(encoding="utf-8")
            for name in chance.sample(mistakes, MISTAKEN)
        ),
        *(ATTACKS[name].program for name in HOSTILE),
        NO_PROGRAM,
    ]


def graded() -> Cost:
    """Grade the class; return the cost of a hand-in."""
    with tempfile.TemporaryDirectory() as folder:
        texts = programs()
        for number, text in enumerate(texts):
            path = Path(folder, f"student{number}", "turtle_controller.py")
            path.parent.mkdir()
            path.write_text(f"{text}\n# {number}\n", encoding="utf-8")  # no two are the same
        cost = grader_call("batch", folder, "--jobs", str(JOBS))
        return Cost(cost.wall_s / len(texts), cost.cpu_s / len(texts))


def main() -> None:
    runner = pyperf.Runner(processes=3, values=3, warmups=1, loops=1)
    runner.bench_time_func("grading, cold", lambda _: grader_call("run", REFERENCE).wall_s)
    runner.bench_time_func("grading, cold: CPU", lambda _: grader_call("run", REFERENCE).cpu_s)
    runner.bench_func("grading, in the call's fork servers", grader.grade, REFERENCE)
    wall = runner.bench_time_func(f"hand-in of a class, {JOBS} jobs", lambda _: graded().wall_s)
    runner.bench_time_func("hand-in of a class: CPU", lambda _: graded().cpu_s)
    if wall is not None and not runner.args.worker:
        print(f"{60 / wall.mean():.0f} hand-ins a minute")


if __name__ == "__main__":
    main()
