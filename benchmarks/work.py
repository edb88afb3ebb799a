"""The measured side of `grading.py`: grades in a process of its own, and reports by lines of JSON.

    python benchmarks/work.py runs SUBMISSION       a run in virtual time for each line on stdin
    python benchmarks/work.py real SUBMISSION       a run in real time for each
    python benchmarks/work.py gradings N SUBMISSION N whole gradings at once for each

It says "ready" first, and ends with its input. `grading.py` reads the processor time in between.
"""

from __future__ import annotations

import json
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))  # this checkout, whatever is installed

import grader  # noqa: E402
from grader.run import real_time, virtual_time  # noqa: E402
from grader.run.plan import Plan  # noqa: E402
from grader.scenes.scene import Limits  # noqa: E402
from grader.submission.opening import open_submission  # noqa: E402

PLAN = Plan(Limits(first_motion_s=5, rest_s=3, total_s=120))


def runs(path: Path) -> None:
    """One run a line; tells when each of its stages began [s, monotonic]."""
    with open_submission(path) as submission:
        say("ready")
        for _ in sys.stdin:
            marks: dict[str, float] = {}
            begun = time.monotonic()
            recording = virtual_time.run(submission, PLAN, marks=marks)
            ended = time.monotonic()
            if recording.run.time != "virtual":
                raise SystemExit(f"{path.stem}: {recording.run.flags}")
            edges = (begun, marks["met"], marks["connected"], marks["over"], ended)
            say({"ticks": recording.run.ticks, "edges": edges})


def real(path: Path) -> None:
    """One run a line; tells how many ticks."""
    with open_submission(path) as submission:
        say("ready")
        for _ in sys.stdin:
            say(real_time.run(submission, PLAN).run.ticks)


def gradings(at_once: int, path: Path) -> None:
    """As many gradings at once, of all its runs each; tells their scores."""
    with ThreadPoolExecutor(at_once) as pool:
        say("ready")
        for _ in sys.stdin:
            say([result.score for result in pool.map(grader.grade, [path] * at_once)])


def say(what: object) -> None:
    """A line for `grading.py`."""
    print(json.dumps(what), flush=True)


if __name__ == "__main__":
    if sys.argv[1] == "gradings":
        gradings(int(sys.argv[2]), Path(sys.argv[3]))
    else:
        {"runs": runs, "real": real}[sys.argv[1]](Path(sys.argv[2]))
