"""Starts the simulator of a run in virtual time; where that cannot work, says so and ends.

    python -m grader.run.simulator.virtual_main ...

The arguments are those of `grader.run.simulator.virtual_time`. Whatever fails in this process
fails here: the grader then runs the submission in real time, and the result says why. Should that
fail as well, it is the grader's failure.
"""

from __future__ import annotations

import json
import os
import sys
import traceback
from pathlib import Path


def main(argv: list[str]) -> int:
    """Run one simulation in lockstep; the grader reads the exit code."""
    try:
        from grader.run.lockstep import contract

        if broken := contract.broken():
            return _refuse(argv, broken)
        from grader.run.simulator import virtual_time

        return virtual_time.main(argv)
    except Exception as error:
        traceback.print_exc()
        return _refuse(argv, f"virtual time itself failed ({_where(error)})")


def _where(error: Exception) -> str:
    frame = traceback.extract_tb(error.__traceback__)[-1]
    return f"{type(error).__name__} in {Path(frame.filename).name}, line {frame.lineno}"


def _refuse(argv: list[str], why: str) -> int:
    message = {"say": "refused", "reason": why}
    os.write(int(argv[0]), json.dumps(message).encode() + b"\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
