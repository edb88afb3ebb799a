"""Right and spoiled behaviour, driven through the real world, gets the verdicts it deserves."""

import dataclasses
import json
import math

import pytest

from grader.exercise.check import judge
from grader.recording.recording import Recordings
from grader.system.strict_json import to_json
from tests.grader.driving import CENTRE, RED, WHITE, Spiral, drive, pen, spoiled, twist
from tests.grader.exercises.turtlesim_challenge.judging import (
    EXERCISE,
    expect_said,
    lost,
    verdicts,
)


def commanding(speed, turn=1.0):
    """A spiral whose commands are made by functions of itself and the tick, or by numbers."""

    def drive(self, tick, arena):
        angular = turn(tick) if callable(turn) else turn
        twist(arena, speed(self, tick) if callable(speed) else speed, angular)

    return spoiled(drive=drive)


def faster(by):
    def speed(self, tick):
        self.speed += by
        return self.speed

    return speed


class PausesOnItsWay(Spiral):
    def __call__(self, tick, pose, arena):
        if not 1000 < tick < 1100:
            super().__call__(tick, pose, arena)


class FloodsCommands(Spiral):
    def __call__(self, tick, pose, arena):
        super().__call__(tick, pose, arena)
        if not self.stopped:
            for _ in range(3):
                twist(arena, self.speed)


class CrashesAtSixSeconds(Spiral):
    def __call__(self, tick, pose, arena):
        if tick < 375:
            super().__call__(tick, pose, arena)


class StartsElsewhere(Spiral):
    def __call__(self, tick, pose, arena):
        if tick == 1:
            arena.teleport_absolute("turtle1", CENTRE + 1.0, CENTRE, 0.0)
        else:
            super().__call__(tick, pose, arena)


OTHER_PENS = spoiled(
    colors={1: (10, 20, 30), 2: (0, 0, 0), 3: (250, 250, 0), 4: (0, 250, 250)},
    entered=lambda self, quadrant, arena: pen(arena, self.colors[quadrant], 7),
)
RIGHT = {
    "the reference": Spiral,
    "clockwise": commanding(faster(0.05), -1.0),
    "backwards": commanding(lambda self, tick: -faster(0.05)(self, tick)),
    "other pens": OTHER_PENS,
    # a wobble that its turns do not cross
    "swings in and out": commanding(
        lambda self, tick: max(0.05, faster(0.05)(self, tick) + 0.08 * math.sin(tick / 20))
    ),
}


@pytest.mark.parametrize("name", RIGHT)
def test_a_right_solution_gets_every_point(name):
    assert lost(verdicts(RIGHT[name], varied=False)) == set()


@pytest.mark.parametrize(
    ("controller", "names"),
    [
        (spoiled(near_edge=lambda self, tick, pose: False), {"edge_stop"}),
        (spoiled(near_edge=lambda self, tick, pose: tick > 1800), {"edge_stop"}),
        (
            spoiled(entered=lambda self, quadrant, arena: None),
            {"pen_per_quadrant", "picture", "no_redundant_calls"},
        ),
        (spoiled(colors={1: WHITE, 2: RED, 3: WHITE, 4: RED}), {"pen_per_quadrant", "picture"}),
        (PausesOnItsWay, {"steady_rate"}),
        (StartsElsewhere, {"spiral"}),
    ],
)
def test_a_spoiled_solution_loses_points_where_it_is_spoiled_and_nowhere_else(controller, names):
    assert lost(verdicts(controller, varied=False)) == names


def test_half_the_colours_earn_half_the_pen_points():
    found = verdicts(spoiled(colors={1: WHITE, 2: RED, 3: WHITE, 4: RED}), varied=False)
    assert found["pen_per_quadrant"].score == pytest.approx(10, abs=0.5)


def test_who_starts_elsewhere_loses_the_start_only_and_is_told_what_would_be_fine():
    found = verdicts(StartsElsewhere, varied=False)["spiral"]
    assert found.score == pytest.approx(0.8 * found.max_score)
    assert "starts 1.00 m from the centre; 0.5 m is fine" in str(found.rationale)
    assert "It earned 30 % for the turns and 50 % for the growth." in str(found.rationale)


@pytest.mark.parametrize("controller", [commanding(0.0, 0.0), commanding(math.nan)])
def test_a_turtle_that_never_moves_or_is_nowhere_earns_nothing(controller):
    assert {each.score for each in verdicts(controller, varied=False, ticks=900).values()} == {0}


def test_an_empty_recording_says_that_no_command_came():
    found = verdicts(lambda: lambda *_: None, varied=False, ticks=900)
    assert str(next(iter(found.values())).rationale).startswith(
        "Your node published no velocity command on /turtle1/cmd_vel in 14.4 s"
    )


def test_a_velocity_that_is_no_number_is_named_and_leaves_finite_evidence():
    late_nan = commanding(lambda self, tick: faster(0.05)(self, tick) if tick < 1500 else math.nan)
    found = verdicts(late_nan, varied=False, ticks=2500)
    assert "not a number" in str(found["edge_stop"].rationale)
    json.dumps([to_json(verdict) for verdict in found.values()], allow_nan=False)


# Shapes, and what was hardly done -----------------------------------------------------------------


class ConcentricCircles:
    """Circles round one place, each reached by driving straight out of the one before."""

    def __call__(self, tick, pose, arena):
        if tick % 5 != 1:
            return
        at, circle = tick % 800, tick // 800
        radius = 0.5 + 0.5 * circle
        if at < 800 - 190:
            twist(arena, 2 * math.pi * radius / (610 * 0.016), 2 * math.pi / (610 * 0.016))
        elif at < 800 - 130:
            twist(arena, 0.0, -math.pi / 2 / (60 * 0.016))
        elif at < 800 - 70:
            twist(arena, 0.5 / (60 * 0.016), 0.0)
        else:
            twist(arena, 0.0, math.pi / 2 / (70 * 0.016))


def test_a_circle_and_concentric_circles_are_no_spiral():
    found = verdicts(ConcentricCircles, varied=False, ticks=8000)["spiral"]
    assert found.score <= 15
    assert "straight outwards" in str(found.rationale)

    class Circle(Spiral):
        def drive(self, tick, arena):
            self.stop(arena) if tick > 1500 else twist(arena, 2.0)

    found = verdicts(Circle, varied=False)
    assert 0 < found["spiral"].score < found["spiral"].max_score
    assert found["edge_stop"].score == 0


def test_driving_to_and_fro_is_no_spiral_that_grows():
    """Half a second ahead, half a second back, turning all the time."""

    def to_and_fro(self, tick):
        return faster(0.05)(self, tick) * (1 if tick // 31 % 2 else -1)

    assert verdicts(commanding(to_and_fro), varied=False)["spiral"].score <= 15
    swings = commanding(faster(0.01), lambda tick: 1.0 if tick % 310 < 155 else -1.0)
    assert "linear.x grew" not in str(verdicts(swings, varied=False)["spiral"].rationale)


def slower(self, tick):
    self.speed = (self.speed or 3.0) - 0.02
    return self.speed


CAUSES = {
    "linear.x was 10 000 000 m/s in the .* divide by 1e9": ("moves", commanding(1e7)),
    "linear.x began at .* Begin small": ("spiral", commanding(slower)),
    "linear.x grew by 1 with each command .* more slowly": ("spiral", commanding(faster(1.0))),
    "angular.z was 0 in every .* angular.z alone": ("spiral", commanding(faster(0.01), 0.0)),
    "all were zeros .* ever set": ("moves", commanding(0.0, 0.0)),
}


@pytest.mark.parametrize("words", CAUSES)
def test_the_commands_tell_the_cause(words):
    check, controller = CAUSES[words]
    expect_said(words, verdicts(controller, varied=False)[check])


def test_a_loop_that_only_publishes_earns_nothing_of_what_reads_the_pose():
    # a loop without end, of which the turtle takes one command a step
    found = verdicts(lambda: lambda tick, pose, arena: twist(arena, 0.55), varied=False)
    reading = ("edge_stop", "pen_per_quadrant", "picture", "no_redundant_calls")
    assert {found[name].score for name in reading} == {0}
    assert found["spiral"].score <= found["spiral"].max_score / 2


def test_several_commands_in_each_step_are_no_rate():
    found = verdicts(FloodsCommands, varied=False)["steady_rate"]
    assert found.score == 0
    assert "nothing makes your node wait" in str(found.rationale)


def test_what_was_hardly_driven_earns_next_to_nothing_and_blames_the_crash_alone():
    found = verdicts(CrashesAtSixSeconds, varied=False)
    assert found["steady_rate"].score + found["no_redundant_calls"].score < 2
    assert "fewer than the 2 turns" in str(found["no_redundant_calls"].rationale)
    recording = drive(CrashesAtSixSeconds(), 1000)
    crashed = dataclasses.replace(recording.run, outcome="crashed", exit_code=1)
    recordings = Recordings(dataclasses.replace(recording, run=crashed))
    found = judge(recordings, EXERCISE.checks, EXERCISE.points, EXERCISE.tolerances)
    failed = [verdict for verdict in found if verdict.status == "failed"]
    assert failed
    assert all(str(verdict.help).startswith("See the error first") for verdict in failed)
