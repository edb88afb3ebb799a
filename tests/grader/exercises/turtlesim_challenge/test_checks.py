"""Right and spoiled behaviour, driven through the real world, gets the verdicts it deserves."""

from __future__ import annotations

import json

import pytest

from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.recording.recording import Recording, Recordings
from grader.strict_json import to_json
from grader.testing import drive, pen, twist
from tests.grader.driving import CENTRE, RED, WHITE, Spiral


def shares(recording: Recording) -> dict[str, float]:
    """The share of its points that each check gives."""
    exercise = load_exercise("turtlesim_challenge")
    verdicts = judge(Recordings(recording), exercise.checks, exercise.points, exercise.tolerances)
    return {verdict.check: verdict.score / verdict.max_score for verdict in verdicts}


class Clockwise(Spiral):
    def drive(self, tick, arena):
        self.speed += 0.05
        twist(arena, self.speed, -1.0)


class OtherColoursAndWidth(Spiral):
    colors = {1: (10, 20, 30), 2: (0, 0, 0), 3: (250, 250, 0), 4: (0, 250, 250)}

    def entered(self, quadrant, arena):
        pen(arena, self.colors[quadrant], 7)


class NeverStops(Spiral):
    def near_edge(self, tick, pose):
        return False


class StopsInTheMiddle(Spiral):
    def near_edge(self, tick, pose):
        return tick > 1800


class FallsSilentAtTheEdge(Spiral):
    def stop(self, arena):
        self.stopped = True


class Circle(Spiral):
    def drive(self, tick, arena):
        if tick > 1500:
            self.stop(arena)
        else:
            twist(arena, 2.0)


class NoPen(Spiral):
    def entered(self, quadrant, arena):
        pass


class TwoColours(Spiral):
    colors = {1: WHITE, 2: RED, 3: WHITE, 4: RED}


class PenOnEveryPose(Spiral):
    def watch(self, tick, pose, arena):
        super().watch(tick, pose, arena)
        if not self.stopped:
            pen(arena, self.colors[self.quadrant_of(pose)])


class PenALongTimeLate(Spiral):
    def __init__(self):
        super().__init__()
        self.due = {}

    def watch(self, tick, pose, arena):
        super().watch(tick, pose, arena)
        for when in [t for t in self.due if t <= tick]:
            pen(arena, self.due.pop(when))

    def entered(self, quadrant, arena):
        self.due[len(self.due) + self.tick_now + 62] = self.colors[quadrant]

    def __call__(self, tick, pose, arena):
        self.tick_now = tick
        super().__call__(tick, pose, arena)


class StandsStill(Spiral):
    def drive(self, tick, arena):
        twist(arena, 0.0, 0.0)


class PausesOnItsWay(Spiral):
    def __call__(self, tick, pose, arena):
        if not 1000 < tick < 1100:
            super().__call__(tick, pose, arena)


@pytest.mark.parametrize("controller", [Spiral, Clockwise, OtherColoursAndWidth])
def test_a_right_solution_gets_every_point(controller):
    assert set(shares(drive(controller())).values()) == {1}


@pytest.mark.parametrize(
    ("controller", "lost"),
    [
        (NeverStops, {"edge_stop"}),
        (StopsInTheMiddle, {"edge_stop"}),
        (FallsSilentAtTheEdge, {"edge_stop"}),
        (NoPen, {"pen_per_quadrant", "picture", "no_redundant_calls"}),
        (TwoColours, {"pen_per_quadrant", "picture"}),
        (PenOnEveryPose, {"no_redundant_calls"}),
        (PausesOnItsWay, {"steady_rate"}),
    ],
)
def test_a_spoiled_solution_loses_points_where_it_is_spoiled_and_nowhere_else(controller, lost):
    found = shares(drive(controller()))
    assert {name for name, share in found.items() if share < 1} == lost


def test_a_circle_keeps_the_points_for_start_and_turns_only():
    found = shares(drive(Circle()))
    assert 0 < found["spiral"] < 1
    assert found["edge_stop"] == 0


def test_late_colours_lose_pen_points():
    found = shares(drive(PenALongTimeLate()))
    assert found["pen_per_quadrant"] < found["spiral"] == 1


def test_half_the_colours_earn_half_the_pen_points():
    assert shares(drive(TwoColours()))["pen_per_quadrant"] == pytest.approx(0.5, abs=0.025)


def test_a_turtle_that_never_moves_earns_nothing():
    assert set(shares(drive(StandsStill(), ticks=900)).values()) == {0}


def test_an_empty_recording_says_that_no_command_came():
    exercise = load_exercise("turtlesim_challenge")
    recording = drive(lambda *_: None, ticks=900)
    first = judge(Recordings(recording), exercise.checks, exercise.points, exercise.tolerances)[0]
    assert str(first.rationale).startswith(
        "Your node published no velocity command on /turtle1/cmd_vel in 14.4 s"
    )


def test_a_path_that_starts_elsewhere_loses_the_start_only():
    spiral = Spiral()

    def controller(tick, pose, arena):
        if tick == 1:
            arena.teleport_absolute("turtle1", CENTRE + 1.0, CENTRE, 0.0)
        elif tick > 2:
            spiral(tick, pose, arena)

    found = shares(drive(controller))
    assert found["spiral"] == pytest.approx(0.8)


class SendsNotANumber(Spiral):
    def drive(self, tick, arena):
        self.speed += 0.05
        twist(arena, self.speed if tick < 1500 else float("nan"))


def test_a_velocity_that_is_no_number_is_named_and_leaves_finite_evidence():
    exercise = load_exercise("turtlesim_challenge")
    recordings = Recordings(drive(SendsNotANumber(), ticks=2500))
    verdicts = judge(recordings, exercise.checks, exercise.points, exercise.tolerances)
    stop = next(verdict for verdict in verdicts if verdict.check == "edge_stop")
    assert "not a number" in str(stop.rationale)
    json.dumps([to_json(verdict) for verdict in verdicts], allow_nan=False)


def test_a_turtle_that_is_never_anywhere_is_judged_without_a_fault():
    def nowhere(tick, pose, arena):
        twist(arena, float("nan"))

    assert set(shares(drive(nowhere, ticks=300)).values()) == {0}


def test_a_right_solution_is_right_wherever_it_starts_and_counting_steps_is_not():
    exercise = load_exercise("turtlesim_challenge")
    starts = [start for seed in (1, 2, 3) for start in exercise.starts(seed)]
    for controller, passes in ((Spiral, True), (CountsItsSteps, False)):
        runs = tuple(drive(controller(), start=start) for start in starts)
        recordings = Recordings(drive(controller()), runs)
        verdicts = judge(recordings, exercise.checks, exercise.points, exercise.tolerances)
        assert all(v.status == "passed" for v in verdicts if v.check != "edge_stop")
        stop = next(verdict for verdict in verdicts if verdict.check == "edge_stop")
        assert (stop.status == "passed") == passes
        assert (stop.evidence[0].run == 0) == passes


class CountsItsSteps(Spiral):
    def near_edge(self, tick, pose):
        return self.speed > 5.1


def test_the_evidence_of_a_needless_call_names_tick_and_place():
    exercise = load_exercise("turtlesim_challenge")
    recording = drive(PenOnEveryPose())
    verdicts = judge(Recordings(recording), exercise.checks, exercise.points, exercise.tolerances)
    (evidence, *_) = next(v.evidence for v in verdicts if v.check == "no_redundant_calls")
    assert evidence.tick > 0
    assert evidence.time_s == pytest.approx(evidence.tick * 0.016)
