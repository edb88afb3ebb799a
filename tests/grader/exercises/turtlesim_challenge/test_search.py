"""The search for wrong verdicts drives what it says: right controllers, and one fault at a time."""

from __future__ import annotations

import random
import runpy
from dataclasses import replace
from pathlib import Path

import pytest

from grader.exercise.loading import load_exercise
from scripts.beginners_mistakes import OPERATORS

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


CONTROLLERS = [each.read_text() for each in sorted(SEARCH["RIGHT"].glob("*.py"))]


@pytest.mark.parametrize("operator", OPERATORS, ids=lambda operator: operator.name)
def test_a_mistake_fits_a_right_controller_and_says_which_lines_are_to_be_changed(operator):
    found = [(text, operator.mutant(text, random.Random(1))) for text in CONTROLLERS]
    made = [(text, mutant) for text, mutant in found if mutant is not None]
    assert made
    text, mutant = made[0]
    assert mutant == operator.mutant(text, random.Random(1))
    for text, mutant in made:
        lines = mutant.source.split("\n")
        assert mutant.source != text
        assert mutant.lines
        assert all(1 <= each <= len(lines) for each in mutant.lines)
        if not operator.missing:
            changed = [lines[each - 1] for each in mutant.lines]
            assert any(lines.count(row) > text.split("\n").count(row) for row in changed)
