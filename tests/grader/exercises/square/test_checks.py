"""Squares and other ways, driven through the real world, get the verdicts they deserve."""

import math
import random
from copy import deepcopy

import numpy as np
import pytest

from grader.errors import CheckFailed
from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.exercises.square.checks import Way
from grader.recording.recording import Recordings
from grader.scenes.turtlesim import driven_path
from grader.scenes.turtlesim.driving import twist
from grader.scenes.turtlesim.trace import TurtleTrace
from grader.testing import drive
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.turtle import TICK_S

EXERCISE = load_exercise("square")
FULL = {"drives": 5, "sides": 25, "corners": 20, "straight": 10}
FULL |= {"returns": 15, "stops": 10, "anywhere": 15}
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
    """Drives legs by the clock, some times round, then stops by a command or just falls silent."""

    def __init__(self, legs, rounds=1, stops=True):
        self.legs = legs
        self.length = sum(ticks for ticks, _, _ in legs)
        self.rounds = rounds
        self.stops = stops

    def __call__(self, tick, pose, arena):
        at = tick - 1
        if at < 0 or at > self.length * self.rounds:
            return
        if at == self.length * self.rounds:
            if self.stops:
                twist(arena, 0.0, 0.0)
            return
        at %= self.length
        for ticks, speed, angular in self.legs:
            if at < ticks:
                if at % AGAIN == 0:
                    twist(arena, speed, angular)
                return
            at -= ticks


class Calls(Legs):
    """Makes a call of the arena in one tick; after a call in the first, a node needs a moment."""

    def __init__(self, call, tick):
        super().__init__(SQUARE)
        self.call = call
        self.tick = tick

    def __call__(self, tick, pose, arena):
        if tick == self.tick:
            self.call(arena)
        super().__call__(tick - 5 if self.tick == 1 else tick, pose, arena)


def jump(arena):
    arena.teleport_absolute("turtle1", 3.0, 3.0, 0.5)


def take_another(arena):
    arena.kill("turtle1")
    arena.spawn(5.0, 5.0, 0.0, "turtle1")


SQUARE = polygon([2] * 4)


def recorded(controller, seed=None):
    """The recordings of a node that behaves as a copy of `controller` does."""
    ticks = round(EXERCISE.limits.total_s / TICK_S)
    nominal, *varied = [
        drive(deepcopy(controller), ticks, start) for start in (None, *EXERCISE.starts(seed))
    ]
    return Recordings(nominal, tuple(varied))


def judged(recordings):
    """The verdicts by their names."""
    verdicts = judge(recordings, EXERCISE.checks, EXERCISE.points, EXERCISE.tolerances)
    return {verdict.check: verdict for verdict in verdicts}


def scores(verdicts):
    return {name: verdict.score for name, verdict in verdicts.items()}


def but(**lost):
    return FULL | lost


# Right ones ---------------------------------------------------------------------------------------


class Sideways:
    """A holonomic turtle needs no turn."""

    def __call__(self, tick, pose, arena):
        if tick == 1:
            arena.set_parameter("holonomic", True)
        side, at = divmod(tick - 2, 125)
        if side <= 4 and at in ((0,) if side == 4 else (0, 40, 80)):
            x, y = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (0.0, 0.0)][side]
            arena.command("turtle1", (x, y, 0.0), (0.0, 0.0, 0.0))


RIGHT = {
    "anticlockwise": Legs(SQUARE),
    "clockwise": Legs(polygon([2] * 4, -QUARTER)),
    "without a turn at the end": Legs(SQUARE[:-1]),
    "turning first": Legs([turn(1.0), *SQUARE]),
    "slow": Legs(polygon([2] * 4, speed=0.3, turning=0.5)),
    "fast": Legs(polygon([2] * 4, speed=4.0, turning=6.0)),
    "backwards": Legs([(ticks, -speed, angular) for ticks, speed, angular in SQUARE]),
    "sideways": Sideways(),
    "from the middle of a side": Legs([ahead(1), turn(QUARTER), *polygon([2] * 3), ahead(1)]),
    "with pauses": Legs([leg for each in SQUARE for leg in (each, (60, 0.0, 0.0))]),
    "a little crooked": Legs([leg for _ in range(4) for leg in (*wave(2, 0.05), turn(QUARTER))]),
    "a little off": Legs(polygon([2.1, 1.95, 2.05, 2.0], math.radians(91))),
    "corners rounded by 0.3 m": Legs(rounded(0.3)),
}


@pytest.mark.parametrize("name", RIGHT)
def test_a_right_square_gets_all_points(name):
    assert scores(judged(recorded(RIGHT[name]))) == FULL


@pytest.mark.parametrize("seed", [1, 2])
def test_it_does_not_matter_where_the_varied_runs_start(seed):
    assert judged(recorded(Legs(SQUARE), seed))["anywhere"].status == "passed"


@pytest.mark.parametrize("call", [jump, Arena.reset, take_another])
def test_it_may_jump_before_it_drives_but_then_nothing_shows_that_it_starts_anywhere(call):
    verdicts = judged(recorded(Calls(call, 1)))
    assert scores(verdicts) == but(anywhere=0)
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
WRONG = {
    "stands still": (lambda *_: None, NOTHING),
    "turns on the spot": (Legs([turn(20.0)]), NOTHING),
    "triangle": (
        Legs(polygon([2] * 3, math.radians(120))),
        but(sides=18.75, corners=0, straight=0, anywhere=6.56),
    ),
    "rectangle": (Legs(polygon([2, 3] * 2)), but(sides=12.5, anywhere=13.12)),
    "rhombus": (
        Legs([leg for a in (1.2, 1.94) * 2 for leg in (ahead(2), turn(a))]),
        but(corners=0, straight=0, anywhere=7.5),
    ),
    "stops half-way down the last side": (
        Legs([*polygon([2] * 3), ahead(0.8)]),
        but(sides=18.75, corners=15, straight=0, returns=0, anywhere=5.62),
    ),
    "stops 0.3 m before its start": (
        Legs([*polygon([2] * 3), ahead(1.7)]),
        but(sides=18.75, returns=7.5, anywhere=12.19),
    ),
    "there and back": (
        Legs([ahead(2), turn(math.pi), ahead(2)]),
        but(sides=12.5, corners=0, straight=0, anywhere=5.62),
    ),
    "circle": (
        Legs([bend(2 * math.pi, 4 / math.pi)]),
        but(sides=0, corners=0, straight=0, anywhere=3.75),
    ),
    "too crooked": (
        Legs([leg for _ in range(4) for leg in (*wave(2, 0.15), turn(QUARTER))]),
        but(straight=0, anywhere=11.25),
    ),
    "one side crooked": (
        Legs([*polygon([2] * 3), *wave(2, 0.15)]),
        but(straight=7.5, anywhere=14.06),
    ),
    "corners rounded by 0.5 m": (Legs(rounded(0.5)), but(sides=12.5, straight=0, anywhere=9.38)),
    "never stops": (Legs(SQUARE, rounds=10_000), but(returns=7.5, stops=0, anywhere=13.12)),
    "twice round": (Legs(SQUARE, rounds=2), but(returns=7.5, anywhere=13.12)),
    "falls silent a second before its start": (
        Legs([*polygon([2] * 3), ahead(1)], stops=False),
        but(stops=5),
    ),
    "falls silent at its start": (
        Legs([*polygon([2] * 3), ahead(2)], stops=False),
        but(returns=7.5, stops=5, anywhere=13.12),
    ),
    "crashes in the second side": (
        Legs([ahead(2), turn(QUARTER), ahead(1)], stops=False),
        but(sides=12.5, corners=5, straight=0, returns=0, stops=5, anywhere=2.81),
    ),
    "jumps from corner to corner": (Calls(jump, 200), NOTHING),
    "starts anew in the middle": (Calls(Arena.reset, 200), NOTHING),
    "commands what is no number": (
        Calls(lambda arena: twist(arena, math.nan, math.inf), 200),
        NOTHING,
    ),
    "takes another turtle": (Calls(take_another, 200), NOTHING),
    "goes to fixed places": (GoesToPlaces(), but(anywhere=7.5)),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_one_loses_the_points_of_what_is_wrong_and_is_told_where_to_look(name):
    controller, expected = WRONG[name]
    nominal, *varied = recordings = recorded(controller)
    verdicts = judged(recordings)
    assert scores(verdicts) == expected
    for verdict in verdicts.values():
        assert bool(str(verdict.help)) == (verdict.status != "passed")
        assert len(verdict.evidence) <= 4
        for item in verdict.evidence:
            way = TurtleTrace.of([nominal, *varied][item.run].trace).trajectory()
            row = int(np.flatnonzero(way.ticks == item.tick)[0])
            assert (item.x, item.y) == pytest.approx((way.x[row], way.y[row]), abs=0.001)
            assert item.time_s == pytest.approx(item.tick * TICK_S)
            assert str(item.note)


def test_what_lies_after_the_first_return_is_left_to_another_check_as_the_rubric_says():
    found = judged(recorded(Legs([*SQUARE, *polygon([1, 3], 1.0)])))
    assert scores(found) == but(returns=7.5, anywhere=13.12)
    (rubric,) = (check.rubric for check in EXERCISE.checks if check.name == "sides")
    assert "what turtle1 drives after its first return" in " ".join(str(rubric).split())


def test_a_turtle_that_drives_into_the_wall_draws_no_square():
    verdicts = judged(recorded(Legs([ahead(4), *SQUARE])))
    assert verdicts["sides"].status == "failed"
    assert "5.54" in str(verdicts["sides"].rationale)


def test_an_exercise_that_promises_points_for_other_starts_must_have_them():
    alone = Recordings(drive(Legs(SQUARE)))
    with pytest.raises(CheckFailed, match="varied_runs"):
        judge(alone, EXERCISE.checks, EXERCISE.points, EXERCISE.tolerances)


class StopsAndDrivesOn(Legs):
    """Says once that it stands, and its timer knows nothing of it."""

    def __call__(self, tick, pose, arena):
        super().__call__(tick, pose, arena)
        if tick % AGAIN == 1 and tick > self.length + AGAIN:
            twist(arena, 0.2, 1.0)


def test_who_stops_and_then_drives_on_is_told_when():
    found = judged(recorded(StopsAndDrivesOn(SQUARE)))["stops"]
    assert found.score == 0
    assert "and then your node sent another command" in str(found.rationale)
    assert str(found.evidence[0].note) == "told to stop here"
