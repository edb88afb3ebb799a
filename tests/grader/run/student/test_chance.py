"""What a program draws is the same in every run, whichever way it draws it."""

from __future__ import annotations

import subprocess
import sys

import pytest

from grader.run.plan import Plan
from grader.scenes.scene import Limits
from tests import runs

PLAN = Plan(Limits(first_motion_s=3, rest_s=1, total_s=2))
WAYS = [
    *("random.random()", "random.seed() or random.random()", "random.Random().random()"),
    *("random.SystemRandom().random()", "_random.Random().random()", "os.urandom(8)"),
    *("os.getrandom(8)", "uuid.uuid4()", "secrets.token_hex()"),
    *("ssl.RAND_bytes(8)", "open('/dev/urandom', 'rb').read(8)"),
]


def drawn() -> list[str]:
    """What a process draws by each way, twice."""
    code = (
        "import _random, os, random, secrets, ssl, uuid\n"
        "from grader.run.student import chance\n"
        "chance.install(), chance.replace_surroundings()\n"
        f"for way in {WAYS!r}: print(way, eval(way), eval(way), sep='\\t')"
    )
    command = [sys.executable, "-c", code]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()


def test_two_processes_draw_the_same_and_never_twice() -> None:
    first = drawn()
    assert first == drawn()
    assert [way for way, one, other in (line.split("\t") for line in first) if one == other] == []


def test_two_runs_draw_the_same_and_end_where_they_wait_for_processor_time() -> None:
    one, other = (runs.recorded("draws", PLAN, number=number) for number in (1, 2))
    assert one.output.splitlines()[-1].startswith("uid: (1000, 1000,")
    assert one.output == other.output
    assert one.run.trace_sha256 == other.run.trace_sha256
    assert one.run.outcome == "time_limit"


@pytest.mark.more("as two runs, and eight more")
def test_ten_runs_draw_the_same() -> None:
    hashes = {
        runs.recorded("draws", PLAN, number=number).run.trace_sha256 for number in range(1, 11)
    }
    assert len(hashes) == 1
