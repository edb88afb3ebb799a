"""A package is graded alike at each level of isolation: it is evaluated there as well as run."""

from __future__ import annotations

import pytest

import grader
from grader.exercise.loading import load_exercise
from grader.result.result import Result
from grader.run.processes import levels
from grader.run.processes.levels import LANDLOCK, LIMITS


def graded(name: str, level: str = "") -> Result:
    levels.only(level)
    try:
        return grader.grade(load_exercise(name).folder / "reference", name)
    except levels.NotOffered:
        pytest.skip("not offered here")
    finally:
        levels.only("")


@pytest.mark.parametrize("level", [LANDLOCK, LIMITS])
@pytest.mark.parametrize("name", ["own_interfaces", "talker_listener", "description_package"])
def test_a_package_has_the_same_verdict_at_each_level(name: str, level: str) -> None:
    if name == "description_package":
        pytest.importorskip("grader_robots")
    best, other = graded(name), graded(name, level)
    assert other.run.isolation.startswith(level)
    assert (other.score, other.run.trace_sha256) == (100.0, best.run.trace_sha256)
