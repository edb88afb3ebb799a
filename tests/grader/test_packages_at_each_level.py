"""A package is graded alike at each level of isolation: it is evaluated there as well as run."""

from itertools import product

import pytest

import grader
from grader.exercise.loading import load_exercise
from grader.run.processes import levels
from grader.run.processes.levels import LANDLOCK, LIMITS
from tests import archive
from tests.tiers import others_are_more

NAMES = ("own_interfaces", "talker_listener")


def expect_same_verdict(level, name):
    levels.only(level)
    try:
        result = grader.grade(load_exercise(name).folder / "reference", name)
    except levels.NotOffered:
        pytest.skip("not offered here")
    finally:
        levels.only("")
    assert result.run.isolation.startswith(level)
    best = archive.result(name, "right")
    assert (result.score, result.run.trace_sha256) == (100.0, best.run.trace_sha256)


@pytest.mark.parametrize(
    ("case", "level", "name"),
    others_are_more(
        "tests/attacks does what matters at each level",
        [(f"{name} at {level}", level, name) for level, name in product((LANDLOCK, LIMITS), NAMES)],
        f"own_interfaces at {LIMITS}",
    ),
)
def test_a_package_has_the_same_verdict_at_each_level(case, level, name):
    expect_same_verdict(level, name)
