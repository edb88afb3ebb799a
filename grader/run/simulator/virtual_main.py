"""Starts the simulator of a run in virtual time; where that cannot work, says so and ends.

    python -m grader.run.simulator.virtual_main ...
    python -m grader.run.simulator.virtual_main --zygote SOCKET NEEDED

The arguments are those of `grader.run.simulator.virtual_time`. Whatever fails in this process
fails here: the grader then runs the submission in real time, and the result says why. Should that
fail as well, it is the grader's failure.

As a zygote it imports packages of messages and scenes (NEEDED: a JSON list of two lists of names),
and forks for each order; a child goes on with the arguments of the first form.
"""

from __future__ import annotations

import json
import os
import sys
import traceback
from collections.abc import Sequence
from pathlib import Path

from grader.run.processes import ZYGOTE


def main(argv: list[str]) -> int:
    """Run one simulation in lockstep; the grader reads the exit code."""
    if argv[0] == ZYGOTE:
        argv = become_one_of_many(argv[1:])
    try:
        from grader.run.lockstep import contract

        if broken := contract.broken():
            return _refuse(argv, broken)
        from grader.run.simulator import virtual_time

        return virtual_time.main(argv)
    except Exception as error:
        traceback.print_exc()
        return _refuse(argv, f"virtual time itself failed ({_where(error)})")


def become_one_of_many(words: Sequence[str]) -> list[str]:
    """Be a zygote; returns in each child, with the arguments that it would have been started with.

    Args:
        words: the number of the socket, and what to import.
    """
    from grader.run.lockstep import contract

    if contract.broken():
        sys.exit(1)  # the run says so, when it has started from nothing
    from grader.run.lockstep import preloading
    from grader.run.processes import forking
    from grader.run.simulator import virtual_time  # noqa: F401
    from grader.scenes import load_scene

    number, needed = words
    packages, scenes = json.loads(needed)
    preloading.import_messages(packages)
    for name in scenes:
        load_scene(name).preload()
    command = forking.serve(number, ())
    return command[command.index("-m") + 2 :]


def _where(error: Exception) -> str:
    frame = traceback.extract_tb(error.__traceback__)[-1]
    return f"{type(error).__name__} in {Path(frame.filename).name}, line {frame.lineno}"


def _refuse(argv: list[str], why: str) -> int:
    message = {"say": "refused", "reason": why}
    os.write(int(argv[0]), json.dumps(message).encode() + b"\n")
    return 0


if __name__ == "__main__":
    code = main(sys.argv[1:])
    # All is said and saved. What ROS and Python would still take apart goes with the process.
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    os._exit(code)
