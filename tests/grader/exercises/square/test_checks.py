"""Squares and other ways, driven through the real world, get the verdicts they deserve."""

from __future__ import annotations

import math
import random

import numpy as np
import pytest

from grader.errors import CheckFailed
from grader.exercise import driven_path
from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.exercises.square.checks import Way
from grader.recording.recording import Recordings
from grader.scenes.turtlesim.trace import TurtleTrace
from grader.testing import drive, twist
from turtlesim_py.world.turtle import TICK_S

EXERCISE = load_exercise("square")
FULL = {
    "drives": 5,
    "sides": 25,
    "corners": 20,
    "straight": 10,
    "returns": 15,
    "stops": 10,
    "anywhere": 15,
}
QUARTER = math.pi / 2
#: Ticks between two commands; the simulator stops a turtle that hears nothing for 63.
AGAIN = 20


def ahead(metres, speed=1.0):
    """A leg: ticks, speed, turn; the speed is rounded so that the length is exact."""
    ticks = max(1, round(metres / speed / TICK_S))
    return ticks, metres / ticks / TICK_S, 0.0


def turn(radians, speed=1.5):
    ticks = max(1, round(abs(radians) / speed / TICK_S))
    return ticks, 0.0, radians / ticks / TICK_S


def bend(radians, radius, speed=1.0):
    ticks = max(1, round(abs(radians) * radius / speed / TICK_S))
    return ticks, abs(radians) * radius / ticks / TICK_S, radians / ticks / TICK_S


def polygon(sides, angle=QUARTER, speed=1.0, turning=1.5):
    return [leg for side in sides for leg in (ahead(side, speed), turn(angle, turning))]


def rounded(radius):
    side = [ahead(2 - 2 * radius), bend(QUARTER, radius)]
    return [ahead(2 - radius), *side[1:], *side, *side, ahead(2 - radius)]


def wave(length, height):
    """A side that swings to both sides of the straight line."""
    angle = math.atan2(2 * height, length / 4)
    piece = math.hypot(2 * height, length / 4)
    legs = [turn(angle), ahead(piece / 2)]
    for sign in (-2, 2, -2):
        legs += [turn(sign * angle), ahead(piece)]
    return [*legs, turn(2 * angle), ahead(piece / 2), turn(-angle)]


class Legs:
    """Drives legs by the clock, then stops by a command."""

    stops = True
    rounds = 1

    def __init__(self, legs):
        self.legs = legs

    def __call__(self, tick, pose, arena):
        at = tick - 1
        total = sum(ticks for ticks, _, _ in self.legs)
        if at < 0 or at > total * self.rounds:
            return
        if at == total * self.rounds:
            if self.stops:
                twist(arena, 0.0, 0.0)
            return
        at %= total
        for ticks, speed, angular in self.legs:
            if at < ticks:
                if at % AGAIN == 0:
                    twist(arena, speed, angular)
                return
            at -= ticks


class WithoutEnd(Legs):
    rounds = 10_000


class TwiceRound(Legs):
    rounds = 2


class FallsSilent(Legs):
    """The last command stays in force until the simulator has had enough."""

    stops = False


def recorded(controller, seed=None):
    """The recordings of a node that a call of `controller` makes."""
    ticks = round(EXERCISE.limits.total_s / TICK_S)
    nominal, *varied = [
        drive(controller(), ticks, start) for start in (None, *EXERCISE.starts(seed))
    ]
    return Recordings(nominal, tuple(varied))


def judged(controller, seed=None):
    """The verdicts on it, by their names."""
    return verdicts_on(recorded(controller, seed))


def verdicts_on(recordings):
    verdicts = judge(recordings, EXERCISE.checks, EXERCISE.points, EXERCISE.tolerances)
    return {verdict.check: verdict for verdict in verdicts}


def scores(controller):
    return {name: verdict.score for name, verdict in judged(controller).items()}


# Right ones ---------------------------------------------------------------------------------------

RIGHT = {
    "anticlockwise": polygon([2] * 4),
    "clockwise": polygon([2] * 4, -QUARTER),
    "without a turn at the end": polygon([2] * 4)[:-1],
    "turning first": [turn(1.0), *polygon([2] * 4)],
    "slow": polygon([2] * 4, speed=0.3, turning=0.5),
    "fast": polygon([2] * 4, speed=4.0, turning=6.0),
    "backwards": polygon([2] * 4, speed=1.0) and [(t, -v, w) for t, v, w in polygon([2] * 4)],
    "from the middle of a side": [ahead(1), turn(QUARTER), *polygon([2] * 3), ahead(1)],
    "with pauses": [leg for each in polygon([2] * 4) for leg in (each, (60, 0.0, 0.0))],
    "a little crooked": [leg for _ in range(4) for leg in (*wave(2, 0.05), turn(QUARTER))],
    "a little off": polygon([2.1, 1.95, 2.05, 2.0], math.radians(91)),
    "corners rounded by 0.3 m": rounded(0.3),
}


@pytest.mark.parametrize("legs", RIGHT.values(), ids=RIGHT.keys())
def test_a_right_square_gets_all_points(legs):
    assert scores(lambda: Legs(legs)) == FULL


@pytest.mark.parametrize("seed", range(5))
def test_it_does_not_matter_where_the_varied_runs_start(seed):
    assert judged(lambda: Legs(polygon([2] * 4)), seed)["anywhere"].status == "passed"


class Sideways:
    """A holonomic turtle needs no turn."""

    def __call__(self, tick, pose, arena):
        if tick == 1:
            arena.set_parameter("holonomic", True)
        side, at = divmod(tick - 2, 125)
        if at == 0 and side <= 4:
            x, y = [(1, 0), (0, 1), (-1, 0), (0, -1), (0, 0)][side]
            arena.command("turtle1", (float(x), float(y), 0.0), (0.0, 0.0, 0.0))
        elif at in (40, 80) and side < 4:
            x, y = [(1, 0), (0, 1), (-1, 0), (0, -1)][side]
            arena.command("turtle1", (float(x), float(y), 0.0), (0.0, 0.0, 0.0))


def test_it_may_drive_sideways():
    assert scores(Sideways) == FULL


class JumpsFirst(Legs):
    def __call__(self, tick, pose, arena):
        if tick == 1:
            arena.teleport_absolute("turtle1", 3.0, 3.0, 0.5)
        super().__call__(tick - 5, pose, arena)  # a node may need a moment


class StartsAnewFirst(Legs):
    def __call__(self, tick, pose, arena):
        if tick == 1:
            arena.reset()
        super().__call__(tick - 5, pose, arena)


class TakesAnotherFirst(Legs):
    def __call__(self, tick, pose, arena):
        if tick == 1:
            arena.kill("turtle1")
            arena.spawn(5.0, 5.0, 0.0, "turtle1")
        super().__call__(tick - 5, pose, arena)


@pytest.mark.parametrize("controller", [JumpsFirst, StartsAnewFirst, TakesAnotherFirst])
def test_it_may_jump_before_it_drives_but_then_nothing_shows_that_it_starts_anywhere(controller):
    verdicts = judged(lambda: controller(polygon([2] * 4)))
    assert {name: verdict.score for name, verdict in verdicts.items()} == but(anywhere=0)
    assert "does not count" in str(verdicts["anywhere"].rationale)


class Everywhere(Legs):
    """Another direction and speed in each tick: a corner a tick."""

    def __init__(self):
        super().__init__([])

    def __call__(self, tick, pose, arena):
        chance = random.Random(tick)
        twist(arena, chance.uniform(0, 200), chance.uniform(-200, 200))


def test_a_way_of_a_thousand_corners_is_looked_at_as_far_as_anybody_would(monkeypatch):
    looked = []
    real = driven_path.farthest
    monkeypatch.setattr(driven_path, "farthest", lambda *them: looked.append(1) or real(*them))
    recording = drive(Everywhere(), 4000)
    assert Way(recording, EXERCISE.tolerances).straight_sides()
    assert len(looked) < 10 * 300 * 2


# Wrong ones ---------------------------------------------------------------------------------------


class Jumps(Legs):
    """Has to be somewhere else at once, in the middle of a side."""

    def other(self, arena):
        arena.teleport_absolute("turtle1", 7.0, 7.0, 1.0)

    def __call__(self, tick, pose, arena):
        if tick == 200:
            self.other(arena)
        super().__call__(tick, pose, arena)


class StartsAnew(Jumps):
    def other(self, arena):
        arena.reset()


class NoNumber(Jumps):
    def other(self, arena):
        twist(arena, math.nan, math.inf)


class TakesAnother(Jumps):
    def other(self, arena):
        arena.kill("turtle1")
        arena.spawn(2.0, 2.0, 0.0, "turtle1")


class GoesToPlaces:
    """Knows where the corners are: where else than in the middle of the window."""

    places = [(7.544, 5.544), (7.544, 7.544), (5.544, 7.544), (5.544, 5.544)]

    def __init__(self):
        self.left = list(self.places)

    def __call__(self, tick, pose, arena):
        if pose is None or not self.left:
            return
        x, y = self.left[0]
        gap = math.hypot(x - pose.x, y - pose.y)
        if gap < 0.02:
            self.left.pop(0)
            twist(arena, 0.0, 0.0)
            return
        error = math.remainder(math.atan2(y - pose.y, x - pose.x) - pose.theta, math.tau)
        twist(arena, 0.0 if abs(error) > 0.05 else min(1.0, gap * 4), error * 4)


NOTHING = dict.fromkeys(FULL, 0)


def but(**scores):
    return FULL | scores


WRONG = {
    "stands still": (lambda: lambda *_: None, NOTHING),
    "turns on the spot": (lambda: Legs([turn(20.0)]), NOTHING),
    "triangle": (
        lambda: Legs(polygon([2] * 3, math.radians(120))),
        but(sides=18.75, corners=0, straight=0, anywhere=6.56),
    ),
    "hexagon": (
        lambda: Legs(polygon([2] * 6, math.radians(60))),
        but(sides=16.67, corners=0, straight=0, anywhere=6.25),
    ),
    "sides of 3 m": (lambda: Legs(polygon([3] * 4)), but(sides=0, anywhere=11.25)),
    "rectangle": (lambda: Legs(polygon([2, 3] * 2)), but(sides=12.5, anywhere=13.12)),
    "rhombus": (
        lambda: Legs([leg for a in (1.2, 1.94) * 2 for leg in (ahead(2), turn(a))]),
        but(corners=0, straight=0, anywhere=7.5),
    ),
    "stops half-way down the last side": (
        lambda: Legs([*polygon([2] * 3), ahead(0.8)]),
        but(sides=18.75, corners=15, straight=0, returns=0, anywhere=5.62),
    ),
    "stops 0.3 m before its start": (
        lambda: Legs([*polygon([2] * 3), ahead(1.7)]),
        but(sides=18.75, returns=7.5, anywhere=12.19),
    ),
    "one side": (
        lambda: Legs([ahead(2)]),
        but(sides=6.25, corners=0, straight=0, returns=0, anywhere=0.94),
    ),
    "there and back": (
        lambda: Legs([ahead(2), turn(math.pi), ahead(2)]),
        but(sides=12.5, corners=0, straight=0, anywhere=5.62),
    ),
    "circle": (
        lambda: Legs([bend(2 * math.pi, 4 / math.pi)]),
        but(sides=0, corners=0, straight=0, anywhere=3.75),
    ),
    "too crooked": (
        lambda: Legs([leg for _ in range(4) for leg in (*wave(2, 0.15), turn(QUARTER))]),
        but(straight=0, anywhere=11.25),
    ),
    "one side crooked": (
        lambda: Legs([*polygon([2] * 3), *wave(2, 0.15)]),
        but(straight=7.5, anywhere=14.06),
    ),
    "corners rounded by 0.5 m": (
        lambda: Legs(rounded(0.5)),
        but(sides=12.5, straight=0, anywhere=9.38),
    ),
    "never stops": (
        lambda: WithoutEnd(polygon([2] * 4)),
        but(returns=7.5, stops=0, anywhere=13.12),
    ),
    "twice round": (lambda: TwiceRound(polygon([2] * 4)), but(returns=7.5, anywhere=13.12)),
    "falls silent a second before its start": (
        lambda: FallsSilent([*polygon([2] * 3), ahead(1)]),
        but(stops=5),
    ),
    "falls silent at its start": (
        lambda: FallsSilent([*polygon([2] * 3), ahead(2)]),
        but(returns=7.5, stops=5, anywhere=13.12),
    ),
    "crashes in the second side": (
        lambda: FallsSilent([ahead(2), turn(QUARTER), ahead(1)]),
        but(sides=12.5, corners=5, straight=0, returns=0, stops=5, anywhere=2.81),
    ),
    "jumps from corner to corner": (lambda: Jumps(polygon([2] * 4)), NOTHING),
    "starts anew in the middle": (lambda: StartsAnew(polygon([2] * 4)), NOTHING),
    "commands what is no number": (lambda: NoNumber(polygon([2] * 4)), NOTHING),
    "takes another turtle": (lambda: TakesAnother(polygon([2] * 4)), NOTHING),
    "goes to fixed places": (GoesToPlaces, but(anywhere=7.5)),
}


@pytest.mark.parametrize(("controller", "expected"), WRONG.values(), ids=WRONG.keys())
def test_a_wrong_one_loses_the_points_of_what_is_wrong_and_is_told_where_to_look(
    controller, expected
):
    nominal, *varied = recordings = recorded(controller)
    verdicts = verdicts_on(recordings)
    assert {name: verdict.score for name, verdict in verdicts.items()} == expected
    for verdict in verdicts.values():
        assert bool(str(verdict.help)) == (verdict.status != "passed")
        assert len(verdict.evidence) <= 4
        for item in verdict.evidence:
            way = TurtleTrace.of([nominal, *varied][item.run].trace).trajectory()
            row = int(np.flatnonzero(way.ticks == item.tick)[0])
            assert (item.x, item.y) == pytest.approx((way.x[row], way.y[row]), abs=0.001)
            assert item.time_s == pytest.approx(item.tick * TICK_S)
            assert str(item.note)


def test_a_turtle_that_drives_into_the_wall_draws_no_square():
    verdicts = judged(lambda: Legs([ahead(4), *polygon([2] * 4)]))
    assert verdicts["sides"].status == "failed"
    assert "5.54" in str(verdicts["sides"].rationale)


def test_an_exercise_that_promises_points_for_other_starts_must_have_them():
    alone = Recordings(drive(Legs(polygon([2] * 4))))
    with pytest.raises(CheckFailed, match="varied_runs"):
        judge(alone, EXERCISE.checks, EXERCISE.points, EXERCISE.tolerances)


class StopsAndDrivesOn(Legs):
    """Says once that it stands, and its timer knows nothing of it."""

    def __call__(self, tick, pose, arena):
        total = sum(ticks for ticks, _, _ in self.legs)
        if tick == total + 1:
            twist(arena, 0.0, 0.0)
        elif tick <= total:
            super().__call__(tick, pose, arena)
        elif tick % AGAIN == 1 and tick > total + AGAIN:
            twist(arena, 0.2, 1.0)


def test_who_stops_and_then_drives_on_is_told_when():
    found = judged(lambda: StopsAndDrivesOn(polygon([2] * 4)))["stops"]
    assert found.score == 0
    assert "and then your node sent another command" in str(found.rationale)
    assert str(found.evidence[0].note) == "told to stop here"
