"""Measure what confining a submission's process costs: a table in Markdown, in some seconds.

    .venv/bin/python benchmarks/sandbox.py [--repetitions N]

Each figure is the time from requesting a process to its end, for a process that ends at once:
forked from a server, as nearly all runs are, and started. `none` is a process below its supervisor
that is not confined; the difference to it is the sandbox's. No test reads these numbers.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from measuring import ROOT, head, row, spread

from grader import scratch
from grader.run.processes import levels, network
from grader.run.processes.fork_server import ForkServer
from grader.run.processes.fork_server_main import ProcessCommand
from grader.run.processes.started_process import SubmissionProcess

#: A program that ends at once, started or forked; the arguments of a server follow its code.
ENDS = f"""
import os, sys
sys.path.insert(0, {str(ROOT)!r})
if len(sys.argv) > 1:
    from grader.run.processes import fork_server_main
    fork_server_main.serve(sys.argv[2], ())
os._exit(0)
"""
COMMAND = [sys.executable, "-I", "-S", "-c", ENDS]


@contextmanager
def fork_server(env: dict[str, str]) -> Iterator[ForkServer]:
    """Start a server that forks processes which end at once."""
    made = ForkServer(COMMAND, env)
    made.preloaded()
    try:
        yield made
    finally:
        made.close()


def measure(
    level: levels.Level, warm: ForkServer | None, env: dict[str, str], times: int
) -> list[float]:
    """Measure how long it takes to get a process and see its end [ms]."""
    times_ms = []
    for _ in range(times):
        with scratch.make_folder() as folder, network.obtain_isolation(folder) as isolated:
            (folder / "tmp").mkdir()
            submission = folder / "submission"
            submission.mkdir()
            begin = time.perf_counter()
            confinement = levels.prepare(
                level, submission, folder, is_apart=bool(isolated.namespaces)
            )
            command = ProcessCommand(
                *(COMMAND, {**env, **confinement.env}, confinement.copy, ()),
                *(isolated.namespaces, confinement.order),
            )
            process = SubmissionProcess(command, warm)
            code = process.wait(30.0)
            times_ms.append(1000 * (time.perf_counter() - begin))
            process.end(gently=False)
            if code != 0:
                raise SystemExit(f"it ended with {code}: {process.output()}")
    return times_ms


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--repetitions", type=int, default=30, metavar="N")
    times = parser.parse_args().repetitions
    env = {"PATH": os.environ["PATH"], "PYTHONPATH": str(Path(ROOT))}
    with scratch.make_folder() as folder, network.obtain_isolation(folder) as isolated:
        offered = levels.offered(isolated)
    head("level", "forked [ms]", "started [ms]")
    with fork_server(env) as warm:
        for level in (levels.Level(""), *reversed(offered)):
            forked, started = (measure(level, each, env, times) for each in (warm, None))
            name = f"{level.name() or 'none'}, {level.user}" if level.level else "none"
            row(name, spread(forked, 1), spread(started, 1))


if __name__ == "__main__":
    main()
