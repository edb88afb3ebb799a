"""A busy machine and neighbours slow a run down, but change nothing in it."""

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack

import pytest

from grader.recording.recording import Run
from grader.run import virtual_time
from grader.run.handover import Plan
from grader.run.opening import open_submission
from grader.scenes.scene import Limits
from tests import runs

STYLES = ("timer", "multi_threaded", "rate_with_spin_thread")
NAMES = (*(f"styles/{name}" for name in STYLES), "services/floods_pens")
ENDLESS = [sys.executable, "-S", "-c", "while 1: 0"]
PLAN = Plan(Limits(first_motion_s=3, rest_s=1, total_s=5))


def crowded(name: str) -> Run:
    with open_submission(runs.path_of(name)) as submission:
        return virtual_time.run(submission, PLAN).run


@pytest.mark.more("eight runs, four of them at once beside busy loops")
def test_beside_busy_loops_and_other_runs_every_trace_stays_the_same():
    alone = [runs.recorded(name, PLAN).run for name in NAMES]
    with ExitStack() as loops, ThreadPoolExecutor(4) as pool:
        for _ in range(2):
            loop = loops.enter_context(subprocess.Popen(ENDLESS))
            loops.callback(loop.kill)
        for name, first, again in zip(NAMES, alone, pool.map(crowded, NAMES), strict=True):
            assert (again.time, again.flags) == (first.time, first.flags) == ("virtual", ())
            assert again.trace_sha256 == first.trace_sha256, name
