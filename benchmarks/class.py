"""What a class costs: `grader batch` of twenty hand-ins, with two jobs.

    .venv/bin/python benchmarks/class.py [--fast] [-o FILE.json]

Half of them are right or lack one thing (the challenge's solution and its mutants), a third are
beginners' mistakes, two are hostile, one is no program. It is the same class each time.
"""

from __future__ import annotations

import random
import tempfile
from pathlib import Path

import pyperf
from calls import ROOT, Cost, grader_call

from grader.exercise.loading import load_exercise
from grader.testing.solutions import read_solutions
from tests.submissions.beginners import CHANGED, changed

JOBS = 2
#: How many there are of a kind.
RIGHT, MISTAKEN, HOSTILE = 10, 7, ("imitates_results", "fakes_a_traceback")
NO_PROGRAM = "import rclpy\ndef main()\n    pass\n"


def programs() -> list[str]:
    """Return the texts that are handed in."""
    chance = random.Random(1)
    right = [each.text() for each in read_solutions(load_exercise("turtlesim_challenge"))]
    # except those that use a minute of a processor each
    mistakes = [n for n in sorted(CHANGED) if not n.startswith(("loops", "floods"))]
    attacks = ROOT / "tests" / "attacks" / "submissions"
    return [
        *(right[0] for _ in range(RIGHT // 2)),
        *chance.sample(right, RIGHT - RIGHT // 2),
        *(changed(name) for name in chance.sample(mistakes, MISTAKEN)),
        *((attacks / f"{name}.py").read_text(encoding="utf-8") for name in HOSTILE),
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
    runner = pyperf.Runner(processes=3, values=1, warmups=0, loops=1)
    wall = runner.bench_time_func(f"hand-in of a class, {JOBS} jobs", lambda _: graded().wall_s)
    runner.bench_time_func("hand-in of a class: CPU", lambda _: graded().cpu_s)
    if wall is not None and not runner.args.worker:
        print(f"{60 / wall.mean():.0f} hand-ins a minute")


if __name__ == "__main__":
    main()
