"""What confining a submission's process costs: prints a table in Markdown, takes some seconds.

    .venv/bin/python benchmarks/sandbox.py [--repetitions N]

Each figure is the time from asking for a process to its end, where all that it does is to end:
forked from a zygote, as nearly all runs are, and started. `none` is a process below its supervisor
that is not confined; the difference to it is the sandbox's. No test looks at these numbers.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from measuring import ROOT, spread

sys.path.insert(0, str(ROOT))  # this checkout, whatever is installed

from grader import scratch
from grader.run.processes import isolation, levels
from grader.run.processes.family import Student
from grader.run.processes.zygote import Zygote

#: A program that ends at once, started or forked; what a zygote is told comes after its code.
ENDS = f"""
import os, sys
sys.path.insert(0, {str(ROOT)!r})
if len(sys.argv) > 1:
    from grader.run.processes import forking
    forking.serve(sys.argv[2:], ())
os._exit(0)
"""
COMMAND = [sys.executable, "-I", "-S", "-c", ENDS]


@contextmanager
def zygote(env: dict[str, str]) -> Iterator[Zygote]:
    """One that forks processes which end at once."""
    made = Zygote(COMMAND, env)
    made.preloaded()
    try:
        yield made
    finally:
        made.close()


def measure(
    level: levels.Level, warm: Zygote | None, env: dict[str, str], times: int
) -> list[float]:
    """How long it takes to have a process and see its end [ms]."""
    taken = []
    for _ in range(times):
        with scratch.make_folder() as folder, isolation.obtain_isolation(folder) as isolated:
            (folder / "tmp").mkdir()
            submission = folder / "submission"
            submission.mkdir()
            begin = time.perf_counter()
            place = levels.prepare(
                level, submission, submission, folder, is_apart=bool(isolated.namespaces)
            )
            student = Student(
                *(COMMAND, {**env, **place.env}, submission, ()),
                isolated.namespaces,
                warm,
                place.order,
            )
            code = student.wait(30.0)
            taken.append(1000 * (time.perf_counter() - begin))
            student.end(gently=False)
            if code != 0:
                raise SystemExit(f"it ended with {code}: {student.output()}")
    return taken


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--repetitions", type=int, default=30, metavar="N")
    times = parser.parse_args().repetitions
    env = {"PATH": os.environ["PATH"], "PYTHONPATH": str(Path(ROOT))}
    with scratch.make_folder() as folder, isolation.obtain_isolation(folder) as isolated:
        offered = levels.offered(isolated)
    print("| level | forked [ms] | started [ms] |\n|---|--:|--:|")
    with zygote(env) as warm:
        for level in (levels.Level(""), *reversed(offered)):
            forked, started = (measure(level, each, env, times) for each in (warm, None))
            name = f"{level.name() or 'none'}, {level.user}" if level.level else "none"
            print(f"| {name} | {spread(forked, 1)} | {spread(started, 1)} |", flush=True)


if __name__ == "__main__":
    main()
