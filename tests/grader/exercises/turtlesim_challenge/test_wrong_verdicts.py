"""Controllers that were once judged wrongly, or told what was not the cause."""

from __future__ import annotations

import dataclasses
import math

import pytest

from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.exercises.turtlesim_challenge import colours
from grader.recording.recording import Recordings
from grader.testing import drive, pen, twist
from tests.grader.driving import BLUE, CENTRE, GREEN, RED, WHITE, Spiral
from turtlesim_py.world.turtle import SIZE_M, TICK_S

EXERCISE = load_exercise("turtlesim_challenge")


LIMIT = 11250  # ticks in 180 s


def verdicts(controller, varied=True, ticks=4000, seed=None, **tolerances):
    starts = EXERCISE.starts(seed) if varied else []
    runs = tuple(drive(controller(), ticks, start) for start in starts)
    recordings = Recordings(drive(controller(), ticks), runs)
    found = judge(
        recordings, EXERCISE.checks, EXERCISE.points, {**EXERCISE.tolerances, **tolerances}
    )
    return {verdict.check: verdict for verdict in found}


def total(found):
    return sum(verdict.score for verdict in found.values())


# How it stops -------------------------------------------------------------------------------------


class TurnsAtTheEdge(Spiral):
    """Stops by turning on the spot, and stands a second later."""

    since = 0

    def __call__(self, tick, pose, arena):
        super().__call__(tick, pose, arena)
        self.since += self.stopped
        if self.stopped and tick % 31 == 0:
            self.goes_on(arena)

    def stop(self, arena):
        self.stopped = True
        twist(arena, 0.0, 1.0)

    def goes_on(self, arena):
        twist(arena, 0.0, 1.0 if self.since < 60 else 0.0)


class TurnsForEver(TurnsAtTheEdge):
    def goes_on(self, arena):
        twist(arena, 0.0, 1.0)


class TurnsAndFallsSilent(TurnsAtTheEdge):
    def goes_on(self, arena):
        if self.since < 60:
            twist(arena, 0.0, 1.0)


class FallsSilent(Spiral):
    def stop(self, arena):
        self.stopped = True


class TimerGoesOn(Spiral):
    """Sends its zeros once, and its timer knows nothing of it."""

    def __call__(self, tick, pose, arena):
        super().__call__(tick, pose, arena)
        if self.stopped and tick % 31 == 1:
            self.drive(tick, arena)


def test_who_stops_by_turning_and_then_stands_has_stopped_by_a_command():
    assert verdicts(TurnsAtTheEdge)["edge_stop"].status == "passed"


@pytest.mark.parametrize(
    ("controller", "told"),
    [
        (TurnsForEver, "turned on the spot until the run was over"),
        (TurnsAndFallsSilent, "turn on the spot; that ended only because no more commands came"),
        (FallsSilent, "because no more commands came"),
    ],
)
def test_a_stop_that_is_not_quite_one_is_worth_half_as_in_the_square(controller, told):
    # from where others start, a turtle that nobody stops may roll on into the wall
    found = verdicts(controller, varied=controller is not TurnsForEver, seed=1946)["edge_stop"]
    assert found.score == 12.5
    assert told in str(found.rationale)
    assert "half of the points" in str(found.rationale)


def test_who_stops_and_then_drives_on_is_told_when():
    found = verdicts(TimerGoesOn, varied=False)["edge_stop"]
    assert found.score == 0
    assert "your node stopped it at 50.19 s" in str(found.rationale)
    assert "then sent another command" in str(found.rationale)
    assert "What else in your node publishes" in str(found.help)


class ForgetsToReturn(Spiral):
    """Publishes zeros and then, in the same callback, a speed; nothing after that."""

    def stop(self, arena):
        self.stopped = True
        twist(arena, 0.0, 0.0)
        twist(arena, self.speed)

    def near_edge(self, tick, pose):
        return min(pose.x, pose.y, SIZE_M - pose.x, SIZE_M - pose.y) < 1.5


class SilentAtTheEdge(ForgetsToReturn):
    def stop(self, arena):
        self.stopped = True


def test_who_drives_on_in_the_moment_of_the_stop_is_asked_for_a_return():
    found = verdicts(ForgetsToReturn)["edge_stop"]
    assert "was told to stop at" in str(found.rationale)
    assert "in the same moment to drive on" in str(found.rationale)
    assert "is a `return` missing" in str(found.help)


def test_who_falls_silent_is_told_to_publish_zeros_wherever_that_carries_the_turtle():
    found = verdicts(SilentAtTheEdge)["edge_stop"]
    assert str(found.rationale).startswith("The turtle came to rest because no more commands came")
    assert str(found.help) == "Publish a Twist of zeros to stop."


class NeverStops(Spiral):
    def near_edge(self, tick, pose):
        return False


def test_who_runs_into_a_wall_without_any_stop_is_asked_whether_the_condition_is_ever_true():
    found = verdicts(NeverStops, varied=False)["edge_stop"]
    assert "no Twist of zeros was ever sent" in str(found.rationale)
    assert "`and` or `or`" in str(found.help)


class PausesEachTime(Spiral):
    def __call__(self, tick, pose, arena):
        if tick % 125 == 1:
            self.speed += 0.01
            twist(arena, self.speed, 1.5)


class InDegrees(Spiral):
    def drive(self, tick, arena):
        self.speed += 0.05
        twist(arena, self.speed, 90.0)


class NeverFaster(Spiral):
    def drive(self, tick, arena):
        twist(arena, 0.51, 1.5)


class TurnsFasterToo(Spiral):
    def drive(self, tick, arena):
        self.speed += 0.05
        twist(arena, self.speed, self.speed)


class TwoTimers(Spiral):
    def drive(self, tick, arena):
        self.speed += 0.005
        twist(arena, self.speed)

    def __call__(self, tick, pose, arena):
        super().__call__(tick, pose, arena)
        if tick % 31 == 2:
            twist(arena, 0.0, 1.0)


@pytest.mark.parametrize(
    ("controller", "told", "help_"),
    [
        (PausesEachTime, "A command came every 2.00 s only", "faster than once a second"),
        (InDegrees, "angular.z is 90 rad/s", "not in degrees"),
        (NeverFaster, "linear.x was 0.51 in every command", "grow a little"),
        (TurnsFasterToo, "angular.z grew with linear.x", "constant angular.z"),
        (TwoTimers, "took turns", "one place"),
    ],
)
def test_who_never_comes_near_a_wall_is_told_what_the_commands_show(controller, told, help_):
    found = verdicts(controller, varied=False, ticks=LIMIT // 2)
    assert told in str(found["edge_stop"].rationale).partition(". ")[0]
    assert help_ in str(found["edge_stop"].help)
    assert "came to rest" not in str(found["edge_stop"].rationale)
    assert "-0.00" not in str(found["spiral"].rationale)


class WatchesTheRightWallOnly(Spiral):
    def near_edge(self, tick, pose):
        return pose.x > SIZE_M - 0.5


class WatchesTheTopWallOnly(Spiral):
    def near_edge(self, tick, pose):
        return pose.y > SIZE_M - 0.5


class WatchesTheLeftWallOnly(Spiral):
    def near_edge(self, tick, pose):
        return pose.x < 0.5


class WatchesTheBottomWallOnly(Spiral):
    def near_edge(self, tick, pose):
        return pose.y < 0.5


class WatchesRightAndTopOnly(Spiral):
    def near_edge(self, tick, pose):
        return max(pose.x, pose.y) > SIZE_M - 1.5


class WatchesXOnly(Spiral):
    def near_edge(self, tick, pose):
        return not 1 < pose.x < 10


class WatchesYOnly(Spiral):
    def near_edge(self, tick, pose):
        return not 1 < pose.y < 10


class WatchesLeftAndBottomOnly(Spiral):
    def near_edge(self, tick, pose):
        return min(pose.x, pose.y) < 1.5


@pytest.mark.parametrize(
    "controller",
    [
        WatchesTheRightWallOnly,
        WatchesTheTopWallOnly,
        WatchesTheLeftWallOnly,
        WatchesTheBottomWallOnly,
        WatchesRightAndTopOnly,
        WatchesXOnly,
        WatchesYOnly,
    ],
)
def test_who_watches_one_wall_only_is_told_which_one_is_not_watched(controller):
    found = verdicts(controller, ticks=LIMIT)["edge_stop"]
    assert found.score == 0
    assert "It stopped at the" in str(found.rationale)
    assert str(found.help).endswith(
        "There are four: x and y each have a smallest and a largest value."
    )


def test_who_forgets_the_upper_bounds_is_found_from_starts_on_the_other_side():
    found = verdicts(WatchesLeftAndBottomOnly, seed=1946, ticks=LIMIT)["edge_stop"]
    assert found.score == 0
    assert "It stopped at the" in str(found.rationale)


class CountsItsSteps(Spiral):
    def near_edge(self, tick, pose):
        return self.speed > 5.1


class CountsToASmallerCircle(Spiral):
    """Stops by the radius of its circle, which it knows from its own commands."""

    def near_edge(self, tick, pose):
        return self.speed > 3.6


@pytest.mark.parametrize("controller", [CountsItsSteps, CountsToASmallerCircle])
def test_a_stop_by_the_commands_is_none_by_the_pose(controller):
    found = verdicts(controller)["edge_stop"]
    assert found.score == 0
    assert "at the same moment" in str(found.rationale)


def test_a_stop_by_the_commands_that_is_near_a_wall_by_chance_is_none_either():
    found = verdicts(CountsToASmallerCircle, seed=1946)["edge_stop"]
    assert found.score == 0
    assert "at the same moment" in str(found.rationale)


class Slow(Spiral):
    def drive(self, tick, arena):
        self.speed += 0.012
        twist(arena, self.speed)


class VerySlow(Spiral):
    def drive(self, tick, arena):
        self.speed += 0.005
        twist(arena, self.speed)


def test_a_slow_right_spiral_is_judged_by_the_runs_that_come_near_a_wall():
    found = verdicts(Slow, ticks=LIMIT)
    assert total(found) == 100
    assert "the time, 180 s, was up" in str(found["edge_stop"].rationale)


def test_a_spiral_too_slow_for_any_run_is_told_the_limit_and_nothing_of_windows():
    found = verdicts(VerySlow, varied=False, ticks=LIMIT)["edge_stop"]
    assert "A run lasts 180 s" in str(found.rationale)
    assert "grow faster" in str(found.help)


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


def test_one_timer_of_2_hz_and_the_limits_2_to_9_stop_near_an_edge():
    assert verdicts(OneTimer)["edge_stop"].status == "passed"


class TurnsAndPausesFirst(Spiral):
    def __call__(self, tick, pose, arena):
        if tick == 1:
            twist(arena, 0.0, 1.0)
        if tick > 300:
            super().__call__(tick - 300, pose, arena)


def test_who_turns_on_the_spot_and_pauses_before_driving_is_judged_by_the_driving():
    found = verdicts(TurnsAndPausesFirst)
    assert {name for name, verdict in found.items() if verdict.status != "passed"} <= {
        "steady_rate"
    }


# What was hardly done -----------------------------------------------------------------------------


class CrashesAtSixSeconds(Spiral):
    def __call__(self, tick, pose, arena):
        if tick < 375:
            super().__call__(tick, pose, arena)


class HalfATurn(Spiral):
    """Round to the left, and straight to the wall."""

    def drive(self, tick, arena):
        twist(arena, 1.0, 0.5 if tick < 390 else 0.0)


class PenOff(Spiral):
    def entered(self, quadrant, arena):
        arena.set_pen("turtle1", *self.colors[quadrant], 3, 1)


class FloodsCommands(Spiral):
    def __call__(self, tick, pose, arena):
        super().__call__(tick, pose, arena)
        if not self.stopped:
            for _ in range(3):
                twist(arena, self.speed)


class PublishesWithoutWaiting(Spiral):
    """A loop without end, of which the turtle takes one command a step."""

    def __call__(self, tick, pose, arena):
        twist(arena, 0.55)


def test_a_loop_that_only_publishes_earns_nothing_of_what_reads_the_pose():
    found = verdicts(PublishesWithoutWaiting, varied=False)
    reading = ("edge_stop", "pen_per_quadrant", "picture", "no_redundant_calls")
    assert {found[name].score for name in reading} == {0}
    assert found["spiral"].score <= found["spiral"].max_score / 2


def test_what_was_hardly_driven_earns_next_to_nothing_for_how_it_was_driven():
    found = verdicts(CrashesAtSixSeconds, varied=False)
    assert found["steady_rate"].score + found["no_redundant_calls"].score < 2
    assert "fewer than the 2 turns" in str(found["no_redundant_calls"].rationale)


def test_two_quadrants_are_not_four():
    found = verdicts(HalfATurn, varied=False)
    assert found["pen_per_quadrant"].score == 10
    assert "Of the four quadrants 2 were entered" in str(found["pen_per_quadrant"].rationale)
    assert total(found) < 55


def test_a_pen_that_is_off_is_told_first_and_its_calls_are_worth_nothing():
    found = verdicts(PenOff)
    assert total(found) == 65
    assert "The pen is off everywhere" in str(found["pen_per_quadrant"].rationale)
    assert "`off`" in str(found["no_redundant_calls"].help)


def test_several_commands_in_each_step_are_no_rate():
    found = verdicts(FloodsCommands, varied=False)["steady_rate"]
    assert found.score == 0
    assert "nothing makes your node wait" in str(found.rationale)


# Colours ------------------------------------------------------------------------------------------


class TwoAlike(Spiral):
    colors = {1: WHITE, 2: RED, 3: GREEN, 4: RED}


class HardlyDifferent(Spiral):
    colors = {1: WHITE, 2: (255, 255, 254), 3: GREEN, 4: BLUE}


class FourShades(Spiral):
    colors = {1: (200, 0, 0), 2: (201, 0, 0), 3: (202, 0, 0), 4: (203, 1, 1)}


def test_two_quadrants_of_one_colour_are_named_with_it():
    found = verdicts(TwoAlike)
    told = "Quadrants II and IV are both red (255, 0, 0)."
    assert told in str(found["pen_per_quadrant"].rationale)
    assert told in str(found["picture"].rationale)
    assert str(found["pen_per_quadrant"].rationale).endswith("times 3/4 (colours).")
    assert found["pen_per_quadrant"].score == 15


@pytest.mark.parametrize(("controller", "left"), [(HardlyDifferent, 15), (FourShades, 5)])
def test_colours_that_no_eye_tells_apart_are_one(controller, left):
    found = verdicts(controller)
    assert (found["pen_per_quadrant"].score, found["picture"].score) == (left, 0)


ASKED = {1: list(WHITE), 2: list(RED), 3: list(GREEN), 4: [255, 255, 0]}


def test_an_exercise_may_ask_for_its_own_colours():
    found = verdicts(Spiral, varied=False, colours={**ASKED, 4: list(BLUE)})
    assert total(found) == 100
    found = verdicts(Spiral, varied=False, colours=ASKED)["pen_per_quadrant"]
    assert 14 < found.score < 16
    assert "Quadrant IV is to be yellow (255, 255, 0)." in str(found.rationale)
    assert "draws in blue (0, 0, 255) there, not in yellow" in str(found.evidence[0].note)


class Late(Spiral):
    """Each colour comes some ticks after the turtle; a subclass says how many."""

    ticks = 0

    def __init__(self):
        super().__init__()
        self.due = {}

    def __call__(self, tick, pose, arena):
        self.now = tick
        super().__call__(tick, pose, arena)
        for when in [when for when in self.due if when <= tick]:
            pen(arena, self.due.pop(when))

    def entered(self, quadrant, arena):
        self.due[self.now + self.ticks] = self.colors[quadrant]


class HalfASecondLate(Late):
    ticks = 31


class NineTenthsLate(Late):
    ticks = 56


def test_a_colour_that_is_late_is_told_how_late_and_what_is_allowed():
    found = verdicts(NineTenthsLate, varied=False)["pen_per_quadrant"]
    assert found.score < 5
    assert "The colour comes 0.8" in str(found.rationale)
    assert "0.61 s are allowed" in str(found.rationale)
    note = str(found.evidence[0].note)
    assert note.startswith("enters quadrant IV (bottom right); blue (0, 0, 255) comes 0.67 s later")
    assert note.endswith("until then green (0, 255, 0)")


class DividesAtFive(Spiral):
    def quadrant_of(self, pose):
        if pose.y >= 5.0:
            return 1 if pose.x >= 5.0 else 2
        return 3 if pose.x < 5.0 else 4


class DividesAtSixAndAHalf(Spiral):
    def quadrant_of(self, pose):
        if pose.y >= CENTRE:
            return 1 if pose.x >= 6.5 else 2
        return 3 if pose.x < 6.5 else 4


class ColourOfTheQuadrantBefore(Spiral):
    def watch(self, tick, pose, arena):
        self.before = self.quadrant
        super().watch(tick, pose, arena)

    def entered(self, quadrant, arena):
        if self.before:
            pen(arena, self.colors[self.before])

    def drive(self, tick, arena):
        self.speed += 0.03
        twist(arena, self.speed, 1.5)


class LooksOnceASecond(Spiral):
    def watch(self, tick, pose, arena):
        if tick % 62 == 0 or self.near_edge(tick, pose):
            super().watch(tick, pose, arena)


@pytest.mark.parametrize(
    ("controller", "told", "help_"),
    [
        (DividesAtFive, "The colour changes at x = 5.0 and y = 5.0; the middle", "Which limits"),
        (DividesAtSixAndAHalf, "The colour changes at x = 6.5; the middle", "Which limits"),
        (LooksOnceASecond, "The colour comes now and then only", "not in a slow timer"),
        (NineTenthsLate, "The colour comes 0.8", "what does your node wait for"),
        (TwoAlike, "Quadrants II and IV are both red", "II is x < middle and y > middle; IV is"),
    ],
)
def test_wrong_colours_are_told_by_their_cause_first(controller, told, help_):
    found = verdicts(controller)["pen_per_quadrant"]
    assert str(found.rationale).startswith(told)
    assert help_ in str(found.help)
    assert str(found.rationale).endswith(("(colours).", "no points."))  # how they come about


def test_the_colour_of_the_quadrant_before_is_told_as_that():
    found = verdicts(ColourOfTheQuadrantBefore, seed=1)["pen_per_quadrant"]
    assert "the quadrant that the turtle came from" in str(found.rationale)
    assert "for which does it ask the colour" in str(found.help)


class ColoursByTheCommands(Spiral):
    """Takes the angle that it has turned by for the quadrant that it is in."""

    def watch(self, tick, pose, arena):
        self.angle = tick * TICK_S - math.pi / 2
        super().watch(tick, pose, arena)

    def quadrant_of(self, pose):
        return int(self.angle % math.tau // (math.pi / 2)) + 1


def test_colours_by_the_commands_are_right_in_the_run_from_the_centre_only():
    nominal = verdicts(ColoursByTheCommands, varied=False)["pen_per_quadrant"]
    found = verdicts(ColoursByTheCommands)["pen_per_quadrant"]
    assert nominal.score > 15
    assert found.score < 10
    assert str(found.rationale).startswith("In run 1 (from (3.90, 5.63), driving 0.7")
    assert "they do not come from the pose" in str(found.rationale)


class AlmostRed(Spiral):
    colors = {1: RED, 2: WHITE, 3: (250, 0, 5), 4: BLUE}


def test_colours_that_look_the_same_are_both_named_by_their_numbers():
    found = verdicts(AlmostRed, varied=False)
    told = "I and III are red (255, 0, 0) and red (250, 0, 5): no eye tells them apart."
    assert told in str(found["pen_per_quadrant"].rationale)
    assert told in str(found["picture"].rationale)


@pytest.mark.parametrize(
    ("color", "said"),
    [
        (None, "off"),
        ((0, 128, 0), "dark green (0, 128, 0)"),
        ((179, 184, 255), "the pen's first colour, light blue (179, 184, 255)"),
    ],
)
def test_a_colour_is_called_as_on_the_page(color, said):
    assert str(colours.name(color)) == said


class LiftsThePenFirst(Spiral):
    def entered(self, quadrant, arena):
        arena.set_pen("turtle1", 0, 0, 0, 3, 1)
        super().entered(quadrant, arena)


def test_two_calls_at_each_entry_are_told_as_one_too_many():
    found = verdicts(LiftsThePenFirst, varied=False)["no_redundant_calls"]
    assert "more than once at each entry" in str(found.rationale)
    assert "One call at each entry is enough" in str(found.help)


def test_who_drives_through_few_quadrants_is_sent_to_the_spiral_first():
    found = verdicts(NeverFaster, varied=False)["pen_per_quadrant"]
    assert str(found.help).startswith("Look at the spiral first")


def test_after_a_crash_no_check_blames_what_did_not_come_any_more():
    recording = drive(CrashesAtSixSeconds(), 1000)
    crashed = dataclasses.replace(recording.run, outcome="crashed", exit_code=1)
    recordings = Recordings(dataclasses.replace(recording, run=crashed))
    found = judge(recordings, EXERCISE.checks, EXERCISE.points, EXERCISE.tolerances)
    failed = [verdict for verdict in found if verdict.status == "failed"]
    assert failed
    assert all(str(verdict.help).startswith("See the error first") for verdict in failed)


def test_an_exercise_may_allow_more_than_half_of_a_stay():
    found = verdicts(NineTenthsLate, seed=2022, late_s=1.5)["pen_per_quadrant"]
    assert found.status == "passed"


def test_the_picture_forgives_what_pen_per_quadrant_forgives():
    found = verdicts(HalfASecondLate)
    assert (found["pen_per_quadrant"].score, found["picture"].score) == (20, 5)
    found = verdicts(NineTenthsLate, own_ink=0.75)
    assert (found["pen_per_quadrant"].score, found["picture"].score) == (0, 0)
    assert "75 % or more" in str(found["picture"].rationale)


class ColoursTheBackground(Spiral):
    """Sets the background on entering a quadrant, and never the pen."""

    def entered(self, quadrant, arena):
        for channel, value in zip("rgb", self.colors[quadrant], strict=True):
            arena.set_parameter(f"background_{channel}", value)


def test_the_background_is_not_the_pen():
    found = verdicts(ColoursTheBackground, varied=False)
    assert str(found["pen_per_quadrant"].rationale) == "The pen was never changed."


# Shapes -------------------------------------------------------------------------------------------


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


class SwingsInAndOut(Spiral):
    """A spiral with a wobble that its turns do not cross."""

    def drive(self, tick, arena):
        self.speed += 0.05
        twist(arena, max(0.05, self.speed + 0.08 * math.sin(tick / 20)))


class Backwards(Spiral):
    def drive(self, tick, arena):
        self.speed += 0.05
        twist(arena, -self.speed)


class ToAndFro(Spiral):
    """Half a second ahead, half a second back, turning all the time."""

    def drive(self, tick, arena):
        self.speed += 0.05
        twist(arena, self.speed if tick // 31 % 2 else -self.speed)


def test_concentric_circles_are_no_spiral():
    found = verdicts(ConcentricCircles, varied=False, ticks=8000)["spiral"]
    assert found.score <= 15
    assert "straight outwards" in str(found.rationale)


@pytest.mark.parametrize("controller", [SwingsInAndOut, Backwards])
def test_what_counts_is_the_line_that_is_drawn(controller):
    assert verdicts(controller, varied=False)["spiral"].status == "passed"


def test_driving_to_and_fro_is_no_spiral():
    assert verdicts(ToAndFro, varied=False)["spiral"].score <= 15


def test_who_starts_elsewhere_is_told_what_would_be_fine():
    spiral = Spiral()

    def controller():
        return lambda tick, pose, arena: (
            arena.teleport_absolute("turtle1", CENTRE + 1.0, CENTRE, 0.0)
            if tick == 1
            else spiral(tick, pose, arena)
        )

    found = verdicts(controller, varied=False)["spiral"]
    assert "starts 1.00 m from the centre; 0.5 m is fine" in str(found.rationale)
    assert "It earned 30 % for the turns and 50 % for the growth." in str(found.rationale)


class NanosecondsForSeconds(Spiral):
    def drive(self, tick, arena):
        twist(arena, 1e7)


class BeginsFastAndSlowsDown(Spiral):
    def drive(self, tick, arena):
        self.speed = (self.speed or 3.0) - 0.02
        twist(arena, self.speed)


class GrowsTooFast(Spiral):
    def drive(self, tick, arena):
        self.speed += 1.0
        twist(arena, self.speed)


class NeverTurns(Spiral):
    def drive(self, tick, arena):
        self.speed += 0.01
        twist(arena, self.speed, 0.0)


class SendsZeros(Spiral):
    def drive(self, tick, arena):
        twist(arena, 0.0, 0.0)


class StopsAtTheWall(Spiral):
    def near_edge(self, tick, pose):
        return min(pose.x, pose.y) <= 0 or max(pose.x, pose.y) >= 11.08


class CallsOnce(Spiral):
    called = False

    def entered(self, quadrant, arena):
        if not self.called:
            self.called = True
            super().entered(quadrant, arena)


class GoesByTheta(Spiral):
    def quadrant_of(self, pose):
        return 1 + (pose.theta > 0) + 2 * (abs(pose.theta) > math.pi / 2)


@pytest.mark.parametrize(
    ("controller", "check", "told", "help_"),
    [
        (NanosecondsForSeconds, "moves", "linear.x was 10 000 000 m/s in the", "divide by 1e9"),
        (BeginsFastAndSlowsDown, "spiral", "linear.x began at ", "Begin small"),
        (GrowsTooFast, "spiral", "linear.x grew by 1 with each command", "more slowly"),
        (NeverTurns, "spiral", "angular.z was 0 in every command", "angular.z alone"),
        (SendsZeros, "moves", "all were zeros", "ever set"),
        (StopsAtTheWall, "edge_stop", "was told to stop only then", "too near the walls"),
        (CallsOnce, "pen_per_quadrant", "set_pen was called once in the whole run", "with 5.54"),
    ],
)
def test_the_commands_tell_the_cause(controller, check, told, help_):
    found = verdicts(controller, varied=False)[check]
    assert told in str(found.rationale)
    assert help_ in str(found.help)


def test_colours_by_the_heading_are_told_from_late_ones():
    found = verdicts(GoesByTheta)["pen_per_quadrant"]
    assert found.score < 20
    assert "The colour changes elsewhere than at x = 5.54 or y = 5.54" in str(found.rationale)
    assert str(found.help).startswith("Is it theta, or the time")


class TurnsToAndFro(Spiral):
    def drive(self, tick, arena):
        self.speed += 0.01
        twist(arena, self.speed, 1.0 if tick % 310 < 155 else -1.0)


def test_who_turns_to_and_fro_is_not_told_of_a_speed_that_grows():
    found = verdicts(TurnsToAndFro, varied=False)["spiral"]
    assert "linear.x grew" not in str(found.rationale)
