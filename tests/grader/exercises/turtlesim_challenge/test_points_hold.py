"""Less never earns more: a spiral of which one thing is taken away, then another."""

from functools import cache
from itertools import combinations

import pytest

from tests.grader.driving import Spiral, twist
from tests.grader.exercises.turtlesim_challenge.judging import total, verdicts

TAKEN = (
    *("the stop", "the last command", "a pen", "another pen", "all pens but one", "all pens"),
    *("the growth", "the turn", "some commands", "the end of the way", "all commands"),
)


class Less(Spiral):
    """Draws the spiral without some things."""

    def __init__(self, taken):
        super().__init__()
        self.taken = taken
        self.tick = 0

    def __call__(self, tick, pose, arena):
        self.tick = tick
        if "the end of the way" not in self.taken or tick < 1800:
            super().__call__(tick, pose, arena)

    def near_edge(self, tick, pose):
        return "the stop" not in self.taken and super().near_edge(tick, pose)

    def stop(self, arena):
        if "the last command" in self.taken:
            self.stopped = True
        else:
            super().stop(arena)

    def entered(self, quadrant, arena):
        gone = {"a pen": 3, "another pen": 2}
        if "all pens" in self.taken or quadrant in (gone.get(each) for each in self.taken):
            return
        if "all pens but one" not in self.taken or self.tick < 100:
            super().entered(quadrant, arena)

    def drive(self, tick, arena):
        if "all commands" in self.taken or ("some commands" in self.taken and tick % 400 < 100):
            return
        if "the growth" in self.taken:
            self.speed = 1.0
        if "the turn" in self.taken:
            self.speed += 0.05
            twist(arena, self.speed, 0.0)
            return
        super().drive(tick, arena)


@cache
def points(taken: frozenset[str]) -> float:
    """What the spiral earns without these things."""
    return total(verdicts(lambda: Less(taken), varied=False))


@pytest.mark.parametrize("what", TAKEN)
def test_what_is_taken_away_earns_no_points(what):
    assert points(frozenset((what,))) < points(frozenset()) == 100


@pytest.mark.more("some seconds for each pair")
@pytest.mark.parametrize("pair", [*combinations(TAKEN, 2)], ids=" and ".join)
def test_taking_away_one_thing_more_earns_no_points(pair):
    least = min(points(frozenset((what,))) for what in pair)
    assert points(frozenset(pair)) <= least
