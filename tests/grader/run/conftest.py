"""Runs for the tests of this folder: how long each submission is watched, and waited for."""

import socket
from pathlib import Path
from typing import Any

import pytest

from grader.recording.recording import Recording
from grader.recording.subject import Start
from grader.run import real_time, virtual_time
from grader.run.handover import Plan
from grader.run.limits import Patience
from grader.run.processes import levels
from grader.run.sandbox import landlock
from grader.scenes.scene import Limits
from tests import runs
from tests.tiers import others_are_more, that_apply

LIMITS = Limits(first_motion_s=3, rest_s=1, total_s=60)
#: Of submissions that rest now and then and go on.
LONGER = Limits(first_motion_s=3, rest_s=5, total_s=60)
#: Of those that drive until a wall is near: a tenth of the way.
NEARER = Start(9.3, 5.5, 0.0)
#: Whose limits or patience are shorter: what they do goes on for ever.
SHORTER = {
    "busy_for_ever": (Limits(3, 1, 60), Patience(stall_cpu_s=0.5)),
    "starts_a_program": (Limits(3, 0.2, 10), None),
    "breaks_the_grader": (Limits(3, 0.2, 10), None),
    "stops_itself": (Limits(3, 1, 60), Patience(asleep_s=0.3)),
    "attacks_link": (Limits(1, 0.2, 10), None),
    "floods": (Limits(3, 1, 2), None),
    "floods_without_end": (Limits(3, 1, 2), None),
    "hangs_after_command": (LONGER, Patience(stall_cpu_s=0.5)),
    "hangs_while_driving": (LONGER, Patience(stall_cpu_s=0.5)),
}
#: What there is here, the best first.
LEVELS = {
    "namespaces": levels.here().level == "namespaces",
    "landlock": landlock.abi() > 0,
    "limits": True,
}
CLOCKS = {"virtual": virtual_time.run, "real": real_time.run}
either_clock = pytest.mark.parametrize(
    "clock", others_are_more("the same for seconds", CLOCKS, "virtual")
)


def at_levels(*names: str) -> list[Any]:
    """These levels of isolation, as parameters."""
    return that_apply("there is that level", {name: LEVELS[name] for name in names})


@pytest.fixture(scope="session")
def recorded():
    """Give the recording of a submission, by its name below tests/submissions; `number`: another.

    Made once for all tests, see `tests.runs`.
    """

    def recorded(name: str, number: int = 1) -> Recording:
        usual = LONGER if name.startswith("messages/") else LIMITS
        limits, patience = SHORTER.get(Path(name).stem, (usual, None))
        start = NEARER if name.startswith("styles/") else None
        return runs.recorded(name, Plan(limits, start), patience, number=number)

    return recorded


@pytest.fixture
def ends():
    """Both ends of a link."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with ours, theirs:
        yield ours, theirs


@pytest.fixture
def theirs(ends):
    return ends[1]


class WallClock:
    """Time that passes in sleeps alone."""

    now_s = 0.0

    def monotonic(self) -> float:
        return self.now_s

    def sleep(self, seconds: float) -> None:
        self.now_s += seconds


@pytest.fixture
def wall_clock():
    return WallClock()
