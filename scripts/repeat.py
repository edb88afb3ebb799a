"""Grade a submission again and again on a busy machine; count the different runs.

    python scripts/repeat.py SUBMISSION EXERCISE [--count 100] [--busy 4] [--servers OTHER]

Each grading is one of its own; beside them BUSY processes compute without end. It prints how often
each outcome came: the points, and the traces of all runs. The exit code is 0 where there is one.
With --servers one set of servers does them, and the submission OTHER, of the same exercise, after
each tenth; the first grading is done without.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

import grader  # noqa: E402

Outcome = tuple[object, ...]


def gradings(submission: Path, exercise: str, count: int) -> Iterator[Outcome]:
    """Grade in this process."""
    for _ in range(count):
        result = grader.grade(submission, exercise)
        runs = (result.run, *result.varied_runs)
        yield (result.score, *((run.time, run.trace_sha256[:12]) for run in runs))


def calls(submission: Path, exercise: str, count: int, other: Path) -> Iterator[Outcome]:
    """Grade by servers, which nobody else uses."""
    command = [sys.executable, "-P", "-m", "grader"]
    with tempfile.TemporaryDirectory() as folder:
        env = os.environ | {"TMPDIR": folder, "PYTHONPATH": str(ROOT)}

        def graded(what: Path, **more: str) -> Outcome:
            words = ["run", str(what.resolve()), "--exercise", exercise, "--out", f"{folder}/out"]
            done = subprocess.run(
                [*command, *words], env=env | more, cwd=folder, capture_output=True, text=True
            )
            if done.returncode or "The servers do not" in done.stderr:
                raise SystemExit(done.stderr)
            result = json.loads(Path(folder, "out", "result.json").read_text(encoding="utf-8"))
            runs = (result["run"], *result["varied_runs"])
            return (result["score"], *((r["time"], r["trace_sha256"][:12]) for r in runs))

        yield graded(submission, GRADER_SERVERS="off")
        subprocess.run([*command, "servers", "start"], env=env, check=True)
        try:
            for number in range(1, count):
                yield graded(submission)
                if number % 10 == 0:
                    graded(other)
        finally:
            subprocess.run([*command, "servers", "stop"], env=env, check=True)


def main() -> int:
    """Grade, count, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("submission", type=Path)
    parser.add_argument("exercise")
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--busy", type=int, default=4)
    parser.add_argument("--servers", type=Path, metavar="OTHER")
    args = parser.parse_args()
    began_s = time.monotonic()
    asked = (args.submission, args.exercise, args.count)
    with ExitStack() as held:
        for _ in range(args.busy):
            process = subprocess.Popen([sys.executable, "-c", "while True: pass"])
            held.callback(process.wait)
            held.callback(process.kill)
        found = Counter(calls(*asked, args.servers) if args.servers else gradings(*asked))
    for key, count in found.most_common():
        print(f"{count:4} of {args.count}: {key}")
    print(f"{(time.monotonic() - began_s) / args.count:.2f} s a grading, beside {args.busy}")
    return int(len(found) != 1)


if __name__ == "__main__":
    sys.exit(main())
