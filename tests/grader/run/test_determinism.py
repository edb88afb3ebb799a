"""A busy machine and neighbours slow a run down, but change nothing in it."""

import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager

import pytest

from grader.recording.recording import Run
from grader.run import virtual_time
from grader.run.handover import Plan
from grader.run.opening import open_submission
from grader.scenes.scene import Limits
from tests import runs

NAMES = (
    "styles/timer",
    "styles/multi_threaded",
    "styles/rate_with_spin_thread",
    "services/floods_pens",
)
PLAN = Plan(Limits(first_motion_s=3, rest_s=1, total_s=5))


@contextmanager
def busy_loops(count: int) -> Iterator[None]:
    loops = [subprocess.Popen([sys.executable, "-S", "-c", "while 1: 0"]) for _ in range(count)]
    try:
        yield
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


def crowded(name: str) -> Run:
    with open_submission(runs.path_of(name)) as submission:
        return virtual_time.run(submission, PLAN).run


@pytest.mark.more("eight runs, four of them at once beside busy loops")
def test_beside_busy_loops_and_other_runs_every_trace_stays_the_same():
    alone = [runs.recorded(name, PLAN).run for name in NAMES]
    with busy_loops(2), ThreadPoolExecutor(4) as pool:
        for name, first, again in zip(NAMES, alone, pool.map(crowded, NAMES), strict=True):
            assert (again.time, again.flags) == (first.time, first.flags) == ("virtual", ())
            assert again.trace_sha256 == first.trace_sha256, name
