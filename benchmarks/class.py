"""Measure what a class costs: `grader batch` for 1, 2, 4 jobs.

    .venv/bin/python benchmarks/class.py [--count N ...] [--jobs 1 2 4] [--seed N]

A class made of the fixtures, as Moodle exports it, is graded anew for each number of jobs. About
half are right or lack one thing (the challenge's solution and its mutants), a third are beginners'
mistakes, a tenth is hostile, some cannot be started, and some are copies of others; the same seed
makes the same class. It prints gradings a minute, CPU seconds a grading, what the same call costs
when all is graded, and the peak of memory, all processes together, of one more call; and the cost
of 1,000 and 100,000 submissions.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
from pathlib import Path

from measuring import ROOT, command, head, machine, peak_pss_mib, row, spread

from grader.exercise.loading import load_exercise
from grader.testing.solutions import read_solutions
from tests.submissions.beginners import CHANGED, changed

HOUR_S = 3600.0
ATTACKS = ROOT / "tests" / "attacks" / "submissions"
FIRST = ("Zoë", "Li", "José", "Anna Maria", "O'Neil", "Søren", "Fatıma", "Jürgen", "Nguyễn", "Ada")
LAST = ("Müller", "van der Berg", "Ødegård", "D'Angelo", "Çelik", "Smith", "Łukasz", "García")
#: None needs real time or a minute of a processor, so that the class costs as much as a usual one.
HOSTILE = (
    *("imitates_results", "crashes", "fakes_a_traceback", "prints_escapes", "exits_oddly"),
    *("lies_about_itself", "turns_on_the_spot", "replaces_builtins", "drives_beyond_all_numbers"),
)
UNUSABLE: dict[str, bytes] = {
    "turtle_controller.zip": b"PK\x03\x04 and nothing more",
    "notes.txt": b"I could not do it.\n",
    "turtle_controller.py": b"import rclpy\ndef main()\n    pass\n",
}
#: So many are drawn, and then again: a larger class costs as much a hand-in.
ALIKE = 20
#: Of ten submissions: (number, kind).
SHARES = ((5, "right"), (3, "beginner"), (1, "hostile"), (1, "odd"))


def programs() -> dict[str, list[str]]:
    """Return the texts of programs by their kind."""
    right = [each.text() for each in read_solutions(load_exercise("turtlesim_challenge"))]
    return {
        # the reference more often, as not all students make a mistake; and its mutants
        "right": right[:1] * (len(right) // 2) + right,
        # except those that use a minute of a processor each
        "beginner": [changed(n) for n in sorted(CHANGED) if not n.startswith(("loops", "floods"))],
        "hostile": [(ATTACKS / f"{name}.py").read_text(encoding="utf-8") for name in HOSTILE],
    }


def make(folder: Path, count: int, seed: int) -> None:
    """Write a class into a folder that is not there yet."""
    names = random.Random(seed)
    texts = programs()
    pool = [kind for share, kind in SHARES for _ in range(share)]
    earlier: list[str] = []
    for number in range(count):
        name = f"{names.choice(FIRST)} {names.choice(LAST)}"
        chance = random.Random(f"{seed} {number % ALIKE}")
        at = folder / f"{name}_{100000 + number}_assignsubmission_file_"
        at.mkdir(parents=True)
        kind = chance.choice(pool)
        if kind == "odd" and earlier and chance.random() < 0.5:
            (at / "turtle_controller.py").write_text(chance.choice(earlier), encoding="utf-8")
        elif kind == "odd":
            file = chance.choice(sorted(UNUSABLE))
            (at / file).write_bytes(UNUSABLE[file])
        else:
            text = f"{chance.choice(texts[kind])}\n# {number}\n"
            earlier.append(text)
            (at / "turtle_controller.py").write_text(text, encoding="utf-8")


def measure(submissions: Path, folder: Path, count: int, jobs: list[int]) -> float:
    """Print a row for each number of jobs; return the least CPU time of a grading [s], or 0."""
    call, samples = [sys.executable, "-m", "grader", "batch", str(submissions)], []
    for number in jobs:
        sample = command([*call, "--out", f"{folder}/out{number}", "--jobs", str(number)])
        samples.append(sample.cpu_s / count if sample.cpu_s is not None else None)
        rate = f"{count / sample.wall_s * 60:.0f}"
        again = command([*call, "--out", f"{folder}/out{number}", "--jobs", str(number)])
        peak = peak_pss_mib([*call, "--out", f"{folder}/again{number}", "--jobs", str(number)])
        cells = (rate, spread(samples[-1:]), f"{peak:.0f}", f"{again.wall_s / count:.3f}")
        row(count, number, f"{sample.wall_s:.0f}", *cells)
    return min((sample for sample in samples if sample is not None), default=0.0)


def main() -> None:
    """Make a class, and measure."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--count", type=int, nargs="+", default=[60])
    parser.add_argument("--jobs", type=int, nargs="+", default=[1, 2, 4])
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    print(machine())
    titles = ("wall [s]", "gradings a minute", "CPU a grading [s]", "peak PSS [MiB]")
    head("hand-ins", "jobs", *titles, "the same call again: a hand-in [s]")
    for count in args.count:
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place)
            submissions = folder / "class"
            make(submissions, count, args.seed)
            cpu_s = measure(submissions, folder, count, args.jobs)
    for many in (1_000, 100_000) if cpu_s else ():
        print(f"{many:,} submissions: {many * cpu_s / HOUR_S:.1f} core hours")


if __name__ == "__main__":
    main()
