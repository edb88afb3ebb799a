"""The search for wrong verdicts drives what it says: right controllers, and one fault at a time."""

from __future__ import annotations

import random
import runpy
from dataclasses import replace
from pathlib import Path

import pytest

from grader.exercise.loading import load_exercise

SEARCH = runpy.run_path(str(Path(__file__).parents[4] / "scripts" / "search_wrong_verdicts.py"))
EXERCISE = load_exercise("turtlesim_challenge")
RIGHT = SEARCH["some_style"](random.Random(1))


def lost(style):
    found = SEARCH["judged"](style, EXERCISE)
    return {check for check, (share, _) in found.items() if share < 1}


def test_every_fault_of_the_search_concerns_checks_that_there_are():
    assert {check for checks in SEARCH["FAULTS"].values() for check in checks} <= set(
        EXERCISE.points
    )


@pytest.mark.parametrize(
    ("fault", "expected"),
    [
        ((), set()),
        (("counts",), {"edge_stop"}),
        (("shades",), {"pen_per_quadrant", "picture"}),
        (("every_pose",), {"no_redundant_calls"}),
    ],
)
def test_a_fault_of_the_search_costs_what_it_concerns_and_nothing_else(fault, expected):
    assert lost(replace(RIGHT, faults=fault)) == expected
