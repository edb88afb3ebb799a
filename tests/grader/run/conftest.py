"""Runs for the tests of this folder: made in the background, several at once, each only once."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import pytest

from grader.recording.recording import Recording
from grader.run import virtual_time
from grader.run.plan import Plan
from grader.run.simulator.link import Patience
from grader.scenes.scene import Limits, Start
from grader.submission.opening import open_submission

SUBMISSIONS = Path(__file__).parents[2] / "submissions"
LIMITS = Limits(first_motion_s=3, rest_s=1, total_s=60)
#: Of submissions that rest now and then and go on.
LONGER = Limits(first_motion_s=3, rest_s=5, total_s=60)
#: Of those that drive until a wall is near: a third of the way.
NEARER = Start(8.0, 5.5, 0.0)
#: Whose limits or patience are shorter: what they do goes on for ever.
SHORTER = {
    "busy_for_ever": (Limits(3, 1, 60), Patience(stall_cpu_s=0.5)),
    "loops_for_ever": (Limits(3, 1, 60), Patience(stall_cpu_s=0.5)),
    "blocks_in_c": (Limits(0.5, 0.5, 5), Patience(asleep_s=1.0)),
    "starts_a_program": (Limits(3, 0.2, 10), Patience()),
    "breaks_the_grader": (Limits(3, 0.2, 10), Patience()),
    "stops_itself": (Limits(3, 1, 60), Patience(asleep_s=1.0)),
    "attacks_link": (Limits(1, 0.2, 10), Patience()),
    "floods": (Limits(3, 1, 5), Patience()),
    "floods_without_end": (Limits(3, 1, 5), Patience()),
    "hangs_after_command": (LONGER, Patience(stall_cpu_s=0.5)),
    "hangs_while_driving": (LONGER, Patience(stall_cpu_s=0.5)),
}
Run = Callable[..., Recording]


def _run(name: str) -> Recording:
    usual = LONGER if name.startswith("messages/") else LIMITS
    limits, patience = SHORTER.get(Path(name).stem, (usual, Patience()))
    with open_submission(SUBMISSIONS / f"{name}.py") as submission:
        start = NEARER if name.startswith("styles/") else None
        return virtual_time.run(submission, Plan(limits, start), patience=patience)


def pytest_configure(config: pytest.Config) -> None:
    """Make the mark known."""
    config.addinivalue_line("markers", "records(*names, times=1): runs that a test will ask for")


@pytest.fixture(scope="module")
def recorded(request: pytest.FixtureRequest) -> Iterator[Run]:
    """Give the recording of a submission, by its name below tests/submissions; `number`: another.

    All that the chosen tests ask for are begun with the first (see the mark `records`).
    """
    runs: dict[tuple[str, int], Future[Recording]] = {}
    with ThreadPoolExecutor(2 * (os.cpu_count() or 1)) as pool:

        def recorded(name: str, number: int = 1) -> Recording:
            if (name, number) not in runs:
                runs[name, number] = pool.submit(_run, name)
            return runs[name, number].result()

        for item in request.session.items:
            for mark in item.iter_markers("records"):
                for name in mark.args:
                    for number in range(1, mark.kwargs.get("times", 1) + 1):
                        if (name, number) not in runs:
                            runs[name, number] = pool.submit(_run, name)
        yield recorded
        pool.shutdown(cancel_futures=True)
