"""Grade a submission again and again on a busy machine; count the different runs.

    python scripts/repeat.py SUBMISSION EXERCISE [--count 100] [--busy 4]

Each grading is one of its own; beside them BUSY processes compute without end. It prints how often
each outcome came: the points, and the traces of all runs. The exit code is 0 where there is one.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import time
from collections import Counter
from contextlib import ExitStack
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import grader


def main() -> int:
    """Grade, count, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("submission", type=Path)
    parser.add_argument("exercise")
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--busy", type=int, default=4)
    args = parser.parse_args()
    found, began_s = Counter[tuple[object, ...]](), time.monotonic()
    with ExitStack() as held:
        for _ in range(args.busy):
            process = subprocess.Popen([sys.executable, "-c", "while True: pass"])
            held.callback(process.wait)
            held.callback(process.kill)
        for _ in range(args.count):
            result = grader.grade(args.submission, args.exercise)
            runs = (result.run, *result.varied_runs)
            key = (result.score, *((run.time, run.trace_sha256[:12]) for run in runs))
            found[key] += 1
    for key, count in found.most_common():
        print(f"{count:4} of {args.count}: {key}")
    print(f"{(time.monotonic() - began_s) / args.count:.2f} s a grading, beside {args.busy}")
    return int(len(found) != 1)


if __name__ == "__main__":
    sys.exit(main())
