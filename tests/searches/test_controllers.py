"""Right controllers of any style keep all points; one with a fault loses what that concerns."""

import random
from dataclasses import replace

import pytest

from grader.exercise.loading import load_exercise
from tests.conftest import EXAMPLES
from tests.searches.controllers import FAULTS, lost, some_style

pytestmark = pytest.mark.more("a search; each check has units of its own")
EXERCISE = load_exercise("turtlesim_challenge")


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_costs_what_it_concerns_and_nothing_else(fault):
    style = replace(some_style(random.Random(1)), fault=fault)
    assert lost(style, EXERCISE) == FAULTS[fault]


@pytest.mark.timeout(0)
def test_no_right_controller_loses_a_point():
    styles = [some_style(random.Random(number)) for number in range(max(3, EXAMPLES))]
    assert [style for style in styles if lost(style, EXERCISE)] == []
