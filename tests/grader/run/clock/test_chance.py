"""What a program draws is the same in every run, whichever way it draws it."""

import os
import sys
import tempfile
from pathlib import Path

import pytest

from grader.run.handover import Plan
from grader.scenes.scene import Limits
from tests import runs
from tests.needs import needs
from tests.programs import ran

TESTS = Path(__file__).parents[3]
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
        "from grader.run.clock import time_and_chance\n"
        "time_and_chance.seed_chance(), time_and_chance.replace_user_and_devices()\n"
        f"for way in {WAYS!r}: print(way, eval(way), eval(way), sep='\\t')"
    )
    command = [sys.executable, "-c", code]
    return ran(command, check=True).stdout.splitlines()


def test_two_processes_draw_the_same_and_never_twice():
    first = drawn()
    assert first == drawn()
    assert [way for way, one, other in (line.split("\t") for line in first) if one == other] == []


def test_two_runs_draw_the_same_and_end_where_they_wait_for_processor_time():
    one, other = (runs.recorded("draws", PLAN, number=number) for number in (1, 2))
    assert one.output.splitlines()[-1].startswith("uid: (1000, 1000,")
    assert one.output == other.output
    assert one.run.trace_sha256 == other.run.trace_sha256
    assert one.run.outcome == "time_limit"


#: What a system refuses -> the level that is left.
LEVELS = {"": "namespaces", "namespaces": "landlock", "namespaces,landlock": "limits"}
GRADES_TEN = """
import sys
import grader
for n in range(10):
    run = grader.grade(*sys.argv[1:]).run
    print(run.isolation.split(" ")[0].rstrip(","), run.outcome, run.trace_sha256)
"""


@pytest.fixture
def for_all():
    """A folder that every user may read; pytest's are its own."""
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o755)
        yield Path(folder)


@pytest.mark.more("sixty runs, a second each")
@pytest.mark.parametrize("user", [pytest.param("root", marks=needs("root")), "ordinary"])
def test_ten_gradings_at_each_level_draw_what_the_first_at_the_best_drew(user, for_all):
    exercise = for_all / "short.yaml"
    limits = "{first_motion_s: 3, rest_s: 1, total_s: 2}"
    exercise.write_text(
        f"exercise: turtlesim_challenge\nlimits: {limits}\n"
        "varied_runs: {count: 0}\npoints: {moves: 5}\n"
    )
    (submission,) = TESTS.rglob("submissions/draws.py")
    expected = runs.recorded("draws", PLAN, number=1).run.trace_sha256
    for refused, level in LEVELS.items():
        words = [sys.executable, "-c", GRADES_TEN, submission, exercise]
        if refused:
            words = [sys.executable, TESTS / "refusing.py", refused, *words]
        if os.geteuid() == 0:
            more = ["--root"] if user == "root" else []
            words = [sys.executable, TESTS / "as_user.py", *more, *words]
        done = ran(words, cwd=TESTS.parent)
        assert done.stdout.splitlines() == [f"{level} time_limit {expected}"] * 10, done.stderr
