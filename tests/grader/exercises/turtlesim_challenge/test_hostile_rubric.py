"""Who looks for points without the work finds none: the challenge's rubric, attacked."""

import math

import pytest

from tests.grader.driving import CENTRE, Spiral, spoiled, twist
from tests.grader.exercises.turtlesim_challenge.judging import total, verdicts
from tests.tiers import others_are_more
from turtlesim_py.world.arena import Arena

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


def going_back(calls, begins=4):
    """Dead reckoning after some calls of the arena, each in a tick."""

    def back(self, tick, arena):
        for call in calls.get(tick, ()):
            call(arena)

    return spoiled(DeadReckoning, back=back, begins=begins)


def kill(arena):
    arena.kill("turtle1")


def spawn(arena):
    arena.spawn(CENTRE, CENTRE, 0.0, "turtle1")


def teleport(arena):
    arena.teleport_absolute("turtle1", CENTRE, CENTRE, 0.0)


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


AWAY = {
    "resets": going_back({1: [Arena.reset]}),
    "resets later": going_back({1: [lambda arena: twist(arena, 0.1)], 100: [Arena.reset]}, 104),
    "teleports": going_back({1: [teleport]}),
    "respawns": going_back({1: [kill, spawn]}),
    "respawns later": going_back({2: [kill], 20: [spawn]}, 30),
}


@pytest.mark.parametrize(
    "way",
    others_are_more("the same at another tick", AWAY, "resets later", "respawns"),
)
def test_dead_reckoning_would_do_in_the_run_from_the_centre_and_earns_nothing_in_a_varied_one(way):
    found = verdicts(AWAY[way], varied=False)
    assert (found["edge_stop"].score, found["pen_per_quadrant"].score) == (25, 20)
    found = verdicts(AWAY[way])
    for name in ("edge_stop", "pen_per_quadrant"):
        assert found[name].score == 0
        assert "n run " in str(found[name].rationale)
    assert found["spiral"].status == "passed"


def test_who_feels_for_the_walls_has_touched_them():
    assert verdicts(FeelsTheWalls)["edge_stop"].score == 0


class GoesHome(Spiral):
    """Goes to the centre when all is done."""

    since = 0

    def __call__(self, tick, pose, arena):
        super().__call__(tick, pose, arena)
        self.since += self.stopped
        if self.since == 100:
            arena.reset()


class AsksInVain(Spiral):
    """Asks for a second turtle of the same name."""

    def __call__(self, tick, pose, arena):
        super().__call__(tick, pose, arena)
        if tick == 500:
            arena.spawn(1.0, 1.0, 0.0, "turtle1")


@pytest.mark.parametrize("controller", [GoesHome, AsksInVain])
def test_what_helps_nobody_costs_nothing(controller):
    assert total(verdicts(controller)) == 100


# Kind 3: turns that are no spiral -----------------------------------------------------------------


def pirouettes(tick, pose, arena):
    """A straight line with full turns on the spot."""
    at = tick % 225
    if at in (1, 33):
        twist(arena, 1.0 if at == 1 else 0.0, 0.0 if at == 1 else 2 * math.pi / (192 * 0.016))
    elif at in (80, 130, 180):
        twist(arena, 0.0, 2 * math.pi / (192 * 0.016))


def small_loops(tick, pose, arena):
    """A line of small loops."""
    if tick % 30 == 1:
        twist(arena, 0.6 if tick % 90 == 1 else 0.3, 4.0)


def small_spiral_and_a_line(tick, pose, arena):
    """Two little turns that grow, then straight away with turns on the spot."""
    if tick % 30 == 1 and tick < 850:
        twist(arena, 0.02 + tick / 20000)
    elif tick > 850:
        pirouettes(tick, pose, arena)


def zigzag(tick, pose, arena):
    """To and fro, farther each time, always turning to the same hand."""
    at = tick % 200
    if at in (1, 41, 81, 121):
        twist(arena, 0.0, math.pi / (120 * 0.016))
    elif at == 161:
        twist(arena, 1.0 + tick / 500, 0.0)


def wobbly(tick, pose, arena):
    """A line that bends to the left and to the right."""
    if tick % 5 == 1:
        twist(arena, 0.25, 2.0 * math.sin(tick / 60))


@pytest.mark.parametrize(
    "controller", [pirouettes, small_loops, small_spiral_and_a_line, zigzag, wobbly]
)
def test_turns_alone_make_no_spiral(controller):
    found = verdicts(lambda: controller, varied=False, ticks=2500)["spiral"]
    assert found.score <= 15
    assert str(found.help)


def square_spiral(tick, pose, arena):
    """Corners turned on the spot, each side longer than the one before."""
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


@pytest.mark.parametrize("controller", [lambda: square_spiral, TurnsFirst])
def test_a_spiral_may_turn_on_the_spot(controller):
    assert verdicts(controller, varied=False, ticks=2500)["spiral"].status == "passed"


# Kind 26: nothing drawn ---------------------------------------------------------------------------


class PenUp(Spiral):
    """The colours are right, and the pen does not touch the canvas."""

    def entered(self, quadrant, arena):
        super().entered(quadrant, arena)
        arena.set_pen("turtle1", 0, 0, 0, 0, 1)


class PenUpAndCleared(PenUp):
    def __call__(self, tick, pose, arena):
        if tick == 5:
            arena.spawn(1.0, 1.0, 0.0, "turtle2")
            arena.clear()
        super().__call__(tick, pose, arena)


@pytest.mark.parametrize("controller", [PenUp, PenUpAndCleared])
def test_a_pen_that_is_up_gives_no_quadrant_its_colour(controller):
    found = verdicts(controller, varied=False)
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
    found = verdicts(BlinksAtTheRightMoment, varied=False)
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
    found = verdicts(AnotherDraws, varied=False)
    assert (found["pen_per_quadrant"].score, found["picture"].score) == (0, 0)


DRAWS_IN_THE_BACKGROUND = spoiled(colors={**Spiral.colors, 3: (69, 86, 255)})


class ChangesTheBackground(Spiral):
    def __call__(self, tick, pose, arena):
        if tick == 1:
            for channel, value in zip("rgb", self.colors[2], strict=True):
                arena.set_parameter(f"background_{channel}", value)
        super().__call__(tick, pose, arena)


@pytest.mark.parametrize("controller", [DRAWS_IN_THE_BACKGROUND, ChangesTheBackground])
def test_what_nobody_can_see_is_no_picture(controller):
    found = verdicts(controller, varied=False)["picture"]
    assert found.score == 0
    assert "background" in str(found.help)


# Kind 8: numbers without measure ------------------------------------------------------------------


@pytest.mark.parametrize(
    ("speed", "turn"), [(1.0, 1e3), (1e15, 1e15), (1e300, -1e15), (5e-324, 1e300), (1e15, 5e-324)]
)
def test_judging_ends_whatever_is_commanded(speed, turn):
    def whirl():
        return lambda tick, pose, arena: tick % 30 == 1 and twist(arena, speed, turn)

    found = verdicts(whirl, varied=False, ticks=400)
    assert found["spiral"].score <= 15
