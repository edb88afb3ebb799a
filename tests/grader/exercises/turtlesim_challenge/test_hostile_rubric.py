"""Who looks for points without the work finds none: the challenge's rubric, attacked."""

from __future__ import annotations

import math

import pytest

from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.recording.recording import Recordings
from grader.testing import drive, twist
from tests.grader.driving import CENTRE, Spiral
from turtlesim_py.world.arena import Arena

EXERCISE = load_exercise("turtlesim_challenge")


def verdicts(controller, varied=True, ticks=4000):
    starts = EXERCISE.starts() if varied else []
    runs = tuple(drive(controller(), ticks, start) for start in starts)
    recordings = Recordings(drive(controller(), ticks), runs)
    found = judge(recordings, EXERCISE.checks, EXERCISE.points, EXERCISE.tolerances)
    return {verdict.check: verdict for verdict in found}


def scores(controller, varied=True):
    return {name: verdict.score for name, verdict in verdicts(controller, varied).items()}


# Kind 2: varied runs undone -----------------------------------------------------------------------


class DeadReckoning(Spiral):
    """Drives a turtle of its own in an arena of its own, and believes that it is where that is."""

    begins = 4

    def __init__(self):
        super().__init__()
        self.own = Arena()
        self.pose = None

    def back(self, tick, arena):
        """Bring the turtle to the centre."""

    def __call__(self, tick, pose, arena):
        self.back(tick, arena)
        if tick < self.begins:
            return
        before = self.speed, self.stopped
        super().__call__(tick - self.begins + 1, self.pose, arena)
        if (self.speed, self.stopped) != before:
            twist(self.own, 0.0 if self.stopped else self.speed, 0.0 if self.stopped else 1.0)
        self.pose = self.own.tick()["turtle1"].pose


class Resets(DeadReckoning):
    def back(self, tick, arena):
        if tick == 1:
            arena.reset()


class ResetsLater(DeadReckoning):
    begins = 104

    def back(self, tick, arena):
        if tick == 1:
            twist(arena, 0.1)
        if tick == 100:
            arena.reset()


class Teleports(DeadReckoning):
    def back(self, tick, arena):
        if tick == 1:
            arena.teleport_absolute("turtle1", CENTRE, CENTRE, 0.0)


class Respawns(DeadReckoning):
    def back(self, tick, arena):
        if tick == 1:
            arena.kill("turtle1")
            arena.spawn(CENTRE, CENTRE, 0.0, "turtle1")


class RespawnsLater(DeadReckoning):
    begins = 30

    def back(self, tick, arena):
        if tick == 2:
            arena.kill("turtle1")
        if tick == 20:
            arena.spawn(CENTRE, CENTRE, 0.0, "turtle1")


class FeelsTheWalls(DeadReckoning):
    """Drives into a corner, where it knows its place; a call that does nothing is to hide that."""

    begins = 900

    def back(self, tick, arena):
        if tick in (1, 400):
            arena.rotate_absolute("turtle1", math.pi if tick == 1 else -math.pi / 2, tick)
        if tick in (250, 300, 350, 650, 700, 750):
            twist(arena, 12.0, 0.0)
        if tick == 800:
            arena.spawn(3.0, 3.0, 0.0, "turtle1")


AWAY = [Resets, ResetsLater, Teleports, Respawns, RespawnsLater]


@pytest.mark.parametrize("controller", AWAY)
def test_dead_reckoning_alone_would_do_in_the_run_from_the_centre(controller):
    found = scores(controller, varied=False)
    assert (found["edge_stop"], found["pen_per_quadrant"]) == (25, 20)


@pytest.mark.parametrize("controller", AWAY)
def test_who_brings_the_turtle_back_to_the_centre_earns_nothing_in_a_varied_run(controller):
    found = verdicts(controller)
    for name in ("edge_stop", "pen_per_quadrant"):
        assert found[name].score == 0
        assert "n run " in str(found[name].rationale)
    assert found["spiral"].status == "passed"


def test_who_feels_for_the_walls_has_touched_them():
    found = verdicts(FeelsTheWalls)
    assert found["edge_stop"].score == 0


def test_who_goes_home_when_all_is_done_loses_nothing():
    class GoesHome(Spiral):
        since = 0

        def __call__(self, tick, pose, arena):
            super().__call__(tick, pose, arena)
            self.since += self.stopped
            if self.since == 100:
                arena.reset()

    assert sum(scores(GoesHome).values()) == 100


def test_who_asks_for_a_second_turtle_of_the_same_name_loses_nothing():
    class AsksInVain(Spiral):
        def __call__(self, tick, pose, arena):
            super().__call__(tick, pose, arena)
            if tick == 500:
                arena.spawn(1.0, 1.0, 0.0, "turtle1")

    assert sum(scores(AsksInVain).values()) == 100


# Kind 3: turns that are no spiral -----------------------------------------------------------------


class Pirouettes:
    """A straight line with full turns on the spot."""

    def __call__(self, tick, pose, arena):
        at = tick % 225
        if at in (1, 33):
            twist(arena, 1.0 if at == 1 else 0.0, 0.0 if at == 1 else 2 * math.pi / (192 * 0.016))
        elif at in (80, 130, 180):
            twist(arena, 0.0, 2 * math.pi / (192 * 0.016))


class SmallLoops:
    """A line of small loops."""

    def __call__(self, tick, pose, arena):
        if tick % 30 == 1:
            twist(arena, 0.6 if tick % 90 == 1 else 0.3, 4.0)


class SmallSpiralAndALine:
    """Two little turns that grow, then straight away with turns on the spot."""

    def __call__(self, tick, pose, arena):
        if tick % 30 == 1 and tick < 850:
            twist(arena, 0.02 + tick / 20000)
        elif tick > 850:
            Pirouettes()(tick, pose, arena)


class Zigzag:
    """To and fro, farther each time, always turning to the same hand."""

    def __call__(self, tick, pose, arena):
        at = tick % 200
        if at in (1, 41, 81, 121):
            twist(arena, 0.0, math.pi / (120 * 0.016))
        elif at == 161:
            twist(arena, 1.0 + tick / 500, 0.0)


class Wobbly:
    """A line that bends to the left and to the right."""

    def __call__(self, tick, pose, arena):
        if tick % 5 == 1:
            twist(arena, 0.25, 2.0 * math.sin(tick / 60))


@pytest.mark.parametrize(
    "controller", [Pirouettes, SmallLoops, SmallSpiralAndALine, Zigzag, Wobbly]
)
def test_turns_alone_make_no_spiral(controller):
    found = verdicts(controller, varied=False, ticks=2500)["spiral"]
    assert found.score <= 15
    assert str(found.help)


class SquareSpiral:
    """Corners turned on the spot, each side longer than the one before."""

    def __call__(self, tick, pose, arena):
        at, side = tick % 140, tick // 140
        if at in (1, 50):
            twist(arena, 0.3 + side * 0.2, 0.0)
        elif at in (80, 110):
            twist(arena, 0.0, math.pi / 2 / (60 * 0.016))


class TurnsFirst(Spiral):
    def __call__(self, tick, pose, arena):
        if tick < 450:
            if tick % 30 == 1:
                twist(arena, 0.0, 1.0)
            return
        super().__call__(tick - 449, pose, arena)


@pytest.mark.parametrize("controller", [SquareSpiral, TurnsFirst])
def test_a_spiral_may_turn_on_the_spot(controller):
    assert verdicts(controller, varied=False, ticks=2500)["spiral"].status == "passed"


# Kind 26: nothing drawn ---------------------------------------------------------------------------


class PenUp(Spiral):
    """The colours are right, and the pen does not touch the canvas."""

    def entered(self, quadrant, arena):
        super().entered(quadrant, arena)
        arena.set_pen("turtle1", 0, 0, 0, 0, 1)


class PenUpAndAnother(PenUp):
    def __call__(self, tick, pose, arena):
        if tick == 5:
            arena.spawn(1.0, 1.0, 0.0, "turtle2")
        super().__call__(tick, pose, arena)


class PenUpAndCleared(PenUp):
    def __call__(self, tick, pose, arena):
        if tick == 5:
            arena.clear()
        super().__call__(tick, pose, arena)


@pytest.mark.parametrize("controller", [PenUp, PenUpAndAnother, PenUpAndCleared])
def test_a_pen_that_is_up_gives_no_quadrant_its_colour(controller):
    found = verdicts(controller)
    assert (found["pen_per_quadrant"].score, found["picture"].score) == (0, 0)
    assert "off" in str(found["picture"].help)


class BlinksAtTheRightMoment(Spiral):
    """Touches the canvas only where it is looked at most closely."""

    since = 0

    def __call__(self, tick, pose, arena):
        super().__call__(tick, pose, arena)
        self.since += 1
        if self.since == 45:
            arena.set_pen("turtle1", 0, 0, 0, 0, 1)

    def entered(self, quadrant, arena):
        super().entered(quadrant, arena)
        self.since = 0


def test_a_pen_has_to_be_down_for_most_of_the_way():
    found = verdicts(BlinksAtTheRightMoment)
    assert found["pen_per_quadrant"].score < 5


class AnotherDraws(PenUp):
    """A second turtle draws what turtle1 does not."""

    def __call__(self, tick, pose, arena):
        if tick == 1:
            for number, (x, y) in enumerate([(8, 8), (2, 8), (2, 2), (8, 2)], start=1):
                arena.spawn(float(x), float(y), 0.0, f"helper{number}")
                arena.set_pen(f"helper{number}", *self.colors[number], 50, 0)
        if tick % 50 == 2:
            for number in range(1, 5):
                arena.command(f"helper{number}", (0.5, 0.0, 0.0), (0.0, 0.0, 1.0))
        super().__call__(tick, pose, arena)


def test_what_another_turtle_draws_is_not_turtle1_s():
    found = scores(AnotherDraws)
    assert (found["pen_per_quadrant"], found["picture"]) == (0, 0)


class DrawsInTheBackground(Spiral):
    colors = {**Spiral.colors, 3: (69, 86, 255)}


class ChangesTheBackground(Spiral):
    def __call__(self, tick, pose, arena):
        if tick == 1:
            for channel, value in zip("rgb", self.colors[2], strict=True):
                arena.set_parameter(f"background_{channel}", value)
        super().__call__(tick, pose, arena)


@pytest.mark.parametrize("controller", [DrawsInTheBackground, ChangesTheBackground])
def test_what_nobody_can_see_is_no_picture(controller):
    found = verdicts(controller)["picture"]
    assert found.score == 0
    assert "background" in str(found.help)


# Kind 8: numbers without measure ------------------------------------------------------------------


@pytest.mark.parametrize("turn", [1e3, 1e15, -1e15, 1e300, 5e-324])
@pytest.mark.parametrize("speed", [1.0, 1e15, 1e300, 5e-324])
def test_judging_ends_whatever_is_commanded(speed, turn):
    def whirl():
        return lambda tick, pose, arena: tick % 30 == 1 and twist(arena, speed, turn)

    found = verdicts(whirl, varied=False, ticks=400)
    assert found["spiral"].score <= 15
