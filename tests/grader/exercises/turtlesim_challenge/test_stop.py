"""How it stops: what `edge_stop` finds, and which cause it tells."""

import pytest

from tests.grader.driving import Spiral, spoiled, twist
from tests.grader.exercises.turtlesim_challenge.judging import (
    LIMIT,
    expect_said,
    lost,
    total,
    verdicts,
)
from turtlesim_py.world.turtle import SIZE_M


def silent(self, arena):
    self.stopped = True


class TurnsAtTheEdge(Spiral):
    """Stops by turning on the spot, and stands a second later."""

    since = 0
    later = 0.0  # its angular velocity a second later; None: it sends no more

    def __call__(self, tick, pose, arena):
        super().__call__(tick, pose, arena)
        self.since += self.stopped
        angular = 1.0 if self.since < 60 else self.later
        if self.stopped and tick % 31 == 0 and angular is not None:
            twist(arena, 0.0, angular)

    def stop(self, arena):
        self.stopped = True
        twist(arena, 0.0, 1.0)


class TimerGoesOn(Spiral):
    """Sends its zeros once, and its timer knows nothing of it."""

    def __call__(self, tick, pose, arena):
        super().__call__(tick, pose, arena)
        if self.stopped and tick % 31 == 1:
            self.drive(tick, arena)


class ForgetsToReturn(Spiral):
    """Publishes zeros and then, in the same callback, a speed; nothing after that."""

    def stop(self, arena):
        super().stop(arena)
        twist(arena, self.speed)

    def near_edge(self, tick, pose):
        return min(pose.x, pose.y, SIZE_M - pose.x, SIZE_M - pose.y) < 1.5


class OneTimer(Spiral):
    """Looks at the pose twice a second only, with the limits of a well-known tutorial."""

    def __call__(self, tick, pose, arena):
        if pose is None or tick % 31 != 1 or self.stopped:
            return
        self.watch(tick, pose, arena)
        if not self.stopped:
            self.drive(tick, arena)

    def near_edge(self, tick, pose):
        return not (2 < pose.x < 9 and 2 < pose.y < 9)


CountsItsSteps = spoiled(near_edge=lambda self, tick, pose: self.speed > 5.1)
#: Knows the radius of its circle from its own commands.
CountsToASmallerCircle = spoiled(near_edge=lambda self, tick, pose: self.speed > 3.6)
NOMINAL = {"varied": False}
OTHERS = {"seed": 1946}
#: What is said of a stop: of whose, in which runs, and what it is worth.
STOPS = {
    # from where others start, a turtle that nobody stops may roll on into the wall
    "turned on the spot until the run was over .* half of the points": (
        (spoiled(TurnsAtTheEdge, later=1.0), NOMINAL, 12.5)
    ),
    "turn on the spot; that ended only because no more commands came .* half of the points": (
        (spoiled(TurnsAtTheEdge, later=None), OTHERS, 12.5)
    ),
    "because no more commands came .* half of the points": (spoiled(stop=silent), OTHERS, 12.5),
    "your node stopped it at 50.19 s .* then sent another command .* What else in your node publ": (
        (TimerGoesOn, NOMINAL, 0)
    ),
    "was told to stop at .* in the same moment to drive on .* is a `return` missing": (
        (ForgetsToReturn, {}, 0)
    ),
    "The turtle came to rest because no more commands came .* Publish a Twist of zeros to stop.": (
        (spoiled(ForgetsToReturn, stop=silent), {}, 12.5)
    ),
    "no Twist of zeros was ever sent .* `and` or `or`": (
        (spoiled(near_edge=lambda self, tick, pose: False), NOMINAL, 0)
    ),
    "stopped by a command, 0.79 m from the wall, but .* at the same moment, at 50.6 s": (
        (CountsItsSteps, {}, 0)
    ),
    "in run 2 .* at the same moment, at 35.7 s .* 3.03 m": (CountsToASmallerCircle, {}, 0),
    # near a wall by chance
    "in run 1 .* at the same moment, at 35.7 s .* 3.60 m": (CountsToASmallerCircle, OTHERS, 0),
    "A run lasts 180 s .* grow faster": (
        spoiled(drive=lambda self, tick, arena: grow(self, arena, 0.005)),
        {"varied": False, "ticks": LIMIT},
        0,
    ),
    "was told to stop only then .* too near the walls": (
        (spoiled(near_edge=lambda self, tick, pose: touches(pose)), NOMINAL, 0)
    ),
}


def touches(pose):
    return min(pose.x, pose.y) <= 0 or max(pose.x, pose.y) >= 11.08


def grow(spiral, arena, by, angular=1.0):
    spiral.speed += by
    twist(arena, spiral.speed, angular)


@pytest.mark.parametrize("words", STOPS)
def test_a_stop_that_is_not_right_is_told_by_its_cause(words):
    controller, runs, score = STOPS[words]
    found = verdicts(controller, **runs)["edge_stop"]
    assert found.score == score
    expect_said(words, found)


def test_a_stop_after_turning_and_by_a_timer_of_2_hz_are_by_a_command():
    assert verdicts(TurnsAtTheEdge)["edge_stop"].status == "passed"
    assert verdicts(OneTimer)["edge_stop"].status == "passed"


def test_a_stop_by_the_pose_is_right_wherever_it_starts_and_counting_steps_is_not():
    assert lost(verdicts(Spiral, seed=1)) == set()
    found = verdicts(CountsItsSteps, seed=1)
    assert lost(found) == {"edge_stop"}
    assert found["edge_stop"].evidence[0].run > 0


class PausesEachTime(Spiral):
    def __call__(self, tick, pose, arena):
        if tick % 125 == 1:
            grow(self, arena, 0.01, 1.5)


class TwoTimers(Spiral):
    def drive(self, tick, arena):
        grow(self, arena, 0.005)

    def __call__(self, tick, pose, arena):
        super().__call__(tick, pose, arena)
        if tick % 31 == 2:
            twist(arena, 0.0, 1.0)


InDegrees = spoiled(drive=lambda self, tick, arena: grow(self, arena, 0.05, 90.0))
NeverFaster = spoiled(drive=lambda self, tick, arena: twist(arena, 0.51, 1.5))
TurnsFasterToo = spoiled(drive=lambda self, tick, arena: grow(self, arena, 0.05, self.speed + 0.05))


SHOWN = {
    "A command came every 2.00 s only .* faster than once a second": PausesEachTime,
    "angular.z is 90 rad/s .* not in degrees": InDegrees,
    "linear.x was 0.51 in every command .* grow a little": NeverFaster,
    "angular.z grew with linear.x .* constant angular.z": TurnsFasterToo,
    "took turns .* one place": TwoTimers,
}


@pytest.mark.parametrize("words", SHOWN)
def test_who_never_comes_near_a_wall_is_told_what_the_commands_show(words):
    found = verdicts(SHOWN[words], varied=False, ticks=LIMIT // 2)
    expect_said(words, found["edge_stop"])
    assert words.split(" .* ")[0] in str(found["edge_stop"].rationale).partition(". ")[0]
    assert "came to rest" not in str(found["edge_stop"].rationale)
    assert "-0.00" not in str(found["spiral"].rationale)


WATCHED = {
    "right": lambda pose: pose.x > SIZE_M - 0.5,
    "top": lambda pose: pose.y > SIZE_M - 0.5,
    "left": lambda pose: pose.x < 0.5,
    "bottom": lambda pose: pose.y < 0.5,
    "right and top": lambda pose: max(pose.x, pose.y) > SIZE_M - 1.5,
    "x": lambda pose: not 1 < pose.x < 10,
    "y": lambda pose: not 1 < pose.y < 10,
    "left and bottom": lambda pose: min(pose.x, pose.y) < 1.5,
}


@pytest.mark.parametrize("walls", WATCHED)
def test_who_watches_some_walls_only_is_told_which_one_is_not_watched(walls):
    controller = spoiled(near_edge=lambda self, tick, pose: WATCHED[walls](pose))
    # of those who forget the upper bounds only starts on the other side tell
    seed = 1946 if walls == "left and bottom" else None
    found = verdicts(controller, seed=seed)["edge_stop"]
    assert found.score == 0
    assert "It stopped at the" in str(found.rationale)
    assert str(found.help).endswith(
        "There are four: x and y each have a smallest and a largest value."
    )


def test_a_slow_right_spiral_is_judged_by_the_runs_that_come_near_a_wall():
    slow = spoiled(drive=lambda self, tick, arena: grow(self, arena, 0.012))
    found = verdicts(slow, ticks=LIMIT)
    assert total(found) == 100
    assert "the time, 180 s, was up" in str(found["edge_stop"].rationale)


def test_who_turns_on_the_spot_and_pauses_before_driving_is_judged_by_the_driving():
    class TurnsAndPausesFirst(Spiral):
        def __call__(self, tick, pose, arena):
            if tick == 1:
                twist(arena, 0.0, 1.0)
            if tick > 300:
                super().__call__(tick - 300, pose, arena)

    assert lost(verdicts(TurnsAndPausesFirst)) <= {"steady_rate"}
