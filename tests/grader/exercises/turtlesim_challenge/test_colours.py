"""The colours: what `pen_per_quadrant` and `picture` find, and which cause they tell."""

import math

import pytest

from grader.exercises.turtlesim_challenge import colours
from tests.grader.driving import BLUE, CENTRE, GREEN, RED, WHITE, Spiral, pen, spoiled, twist
from tests.grader.exercises.turtlesim_challenge.judging import expect_said, total, verdicts
from turtlesim_py.world.turtle import TICK_S


def colored(*colors):
    return spoiled(colors=dict(enumerate(colors, start=1)))


class Late(Spiral):
    """Each colour comes some ticks after the turtle."""

    ticks = 56

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


class ColoursByTheCommands(Spiral):
    """Takes the angle that it has turned by for the quadrant that it is in."""

    def watch(self, tick, pose, arena):
        self.angle = tick * TICK_S - math.pi / 2
        super().watch(tick, pose, arena)

    def quadrant_of(self, pose):
        return int(self.angle % math.tau // (math.pi / 2)) + 1


class CallsOnce(Spiral):
    def entered(self, quadrant, arena):
        if not hasattr(self, "called"):
            self.called = True
            super().entered(quadrant, arena)


def dividing_at(x_m, y_m):
    """A spiral that takes another place for the middle."""

    def quadrant_of(self, pose):
        if pose.y >= y_m:
            return 1 if pose.x >= x_m else 2
        return 3 if pose.x < x_m else 4

    return spoiled(quadrant_of=quadrant_of)


def by_theta(self, pose):
    return 1 + (pose.theta > 0) + 2 * (abs(pose.theta) > math.pi / 2)


TWO_ALIKE = colored(WHITE, RED, GREEN, RED)
#: The beginning of the rationale, and words of the help.
WRONG = {
    "The colour changes at x = 5.0 and y = 5.0; the middle .* Which limits": dividing_at(5.0, 5.0),
    "The colour changes at x = 6.5; the middle .* Which limits": dividing_at(6.5, CENTRE),
    "The colour comes now and then only .* not in a slow timer": LooksOnceASecond,
    "The colour comes 0.8 .* what does your node wait for": Late,
    "Quadrants II and IV are both red (255, 0, 0). .* II is x < middle and y > middle;": TWO_ALIKE,
    "In run 1 (from (3.90, 5.63), driving 0.7 .* The colour changes elsewhere than at x = 5.54 or "
    "y = 5.54 .* Is it theta, or the time": spoiled(quadrant_of=by_theta),
}


@pytest.mark.parametrize("words", WRONG)
def test_wrong_colours_are_told_by_their_cause_first(words):
    found = verdicts(WRONG[words])["pen_per_quadrant"]
    assert found.score < 20
    assert str(found.rationale).startswith(words.split(" .* ")[0])
    expect_said(words, found)
    assert str(found.rationale).endswith(("(colours).", "no points."))  # how they come about


def test_the_colour_of_the_quadrant_before_is_told_as_that():
    found = verdicts(ColourOfTheQuadrantBefore, seed=1)["pen_per_quadrant"]
    assert "the quadrant that the turtle came from" in str(found.rationale)
    assert "for which does it ask the colour" in str(found.help)


def test_a_colour_that_is_late_is_told_how_late_and_may_be_allowed():
    found = verdicts(Late, varied=False)["pen_per_quadrant"]
    assert found.score < 5
    assert "The colour comes 0.8" in str(found.rationale)
    assert "0.61 s are allowed" in str(found.rationale)
    note = str(found.evidence[0].note)
    assert note.startswith("enters quadrant IV (bottom right); blue (0, 0, 255) comes 0.67 s later")
    assert note.endswith("until then green (0, 255, 0)")
    found = verdicts(Late, seed=2022, late_s=1.5)["pen_per_quadrant"]
    assert found.status == "passed"


def test_the_picture_forgives_what_pen_per_quadrant_forgives():
    found = verdicts(spoiled(Late, ticks=31))
    assert (found["pen_per_quadrant"].score, found["picture"].score) == (20, 5)
    found = verdicts(Late, own_ink=0.75)
    assert (found["pen_per_quadrant"].score, found["picture"].score) == (0, 0)
    assert "75 % or more" in str(found["picture"].rationale)


@pytest.mark.parametrize(
    ("controller", "left", "told"),
    [
        (TWO_ALIKE, 15, "Quadrants II and IV are both red (255, 0, 0)."),
        (colored(WHITE, (255, 255, 254), GREEN, BLUE), 15, ": no eye tells them apart."),
        (colored((200, 0, 0), (201, 0, 0), (202, 0, 0), (203, 1, 1)), 5, ""),
        (
            *(colored(RED, WHITE, (250, 0, 5), BLUE), 15),
            "I and III are red (255, 0, 0) and red (250, 0, 5): no eye tells them apart.",
        ),
    ],
)
def test_colours_that_no_eye_tells_apart_are_one_and_named(controller, left, told):
    found = verdicts(controller, varied=False)
    assert (found["pen_per_quadrant"].score, found["picture"].score) == (left, 0)
    assert told in str(found["pen_per_quadrant"].rationale)
    assert told in str(found["picture"].rationale)
    assert str(found["pen_per_quadrant"].rationale).endswith("/4 (colours).")


ASKED = {1: list(WHITE), 2: list(RED), 3: list(GREEN), 4: [255, 255, 0]}


def test_an_exercise_may_ask_for_its_own_colours():
    found = verdicts(Spiral, varied=False, colours={**ASKED, 4: list(BLUE)})
    assert total(found) == 100
    found = verdicts(Spiral, varied=False, colours=ASKED)["pen_per_quadrant"]
    assert 14 < found.score < 16
    assert "Quadrant IV is to be yellow (255, 255, 0)." in str(found.rationale)
    assert "draws in blue (0, 0, 255) there, not in yellow" in str(found.evidence[0].note)


def test_colours_by_the_commands_are_right_in_the_run_from_the_centre_only():
    nominal = verdicts(ColoursByTheCommands, varied=False)["pen_per_quadrant"]
    found = verdicts(ColoursByTheCommands)["pen_per_quadrant"]
    assert nominal.score > 15
    assert found.score < 10
    assert str(found.rationale).startswith("In run 1 (from (3.90, 5.63), driving 0.7")
    assert "they do not come from the pose" in str(found.rationale)


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


# The pen itself -----------------------------------------------------------------------------------


def test_a_pen_that_is_off_is_told_first_and_its_calls_are_worth_nothing():
    def entered(self, quadrant, arena):
        arena.set_pen("turtle1", *self.colors[quadrant], 3, 1)

    found = verdicts(spoiled(entered=entered))
    assert total(found) == 65
    assert "The pen is off everywhere" in str(found["pen_per_quadrant"].rationale)
    assert "`off`" in str(found["no_redundant_calls"].help)


def test_two_calls_at_each_entry_are_told_as_one_too_many():
    class LiftsThePenFirst(Spiral):
        def entered(self, quadrant, arena):
            arena.set_pen("turtle1", 0, 0, 0, 3, 1)
            super().entered(quadrant, arena)

    found = verdicts(LiftsThePenFirst, varied=False)["no_redundant_calls"]
    assert "more than once at each entry" in str(found.rationale)
    assert "One call at each entry is enough" in str(found.help)


def test_a_call_with_every_pose_is_needless_and_has_tick_and_place():
    class PenOnEveryPose(Spiral):
        def watch(self, tick, pose, arena):
            super().watch(tick, pose, arena)
            if not self.stopped:
                pen(arena, self.colors[self.quadrant_of(pose)])

    found = verdicts(PenOnEveryPose, varied=False)
    assert {name for name, each in found.items() if each.status != "passed"} == {
        "no_redundant_calls"
    }
    (evidence, *_) = found["no_redundant_calls"].evidence
    assert evidence.tick > 0
    assert evidence.time_s == pytest.approx(evidence.tick * TICK_S)


def test_the_background_and_one_call_are_not_four_pens():
    found = verdicts(CallsOnce, varied=False)["pen_per_quadrant"]
    assert "set_pen was called once in the whole run" in str(found.rationale)
    assert "with 5.54" in str(found.help)

    def entered(self, quadrant, arena):
        for channel, value in zip("rgb", self.colors[quadrant], strict=True):
            arena.set_parameter(f"background_{channel}", value)

    found = verdicts(spoiled(entered=entered), varied=False)
    assert str(found["pen_per_quadrant"].rationale) == "The pen was never changed."


# Few quadrants ------------------------------------------------------------------------------------


def test_few_quadrants_are_not_four_and_point_to_the_spiral():
    """Round to the left, and straight to the wall."""

    def drive(self, tick, arena):
        twist(arena, 1.0, 0.5 if tick < 390 else 0.0)

    found = verdicts(spoiled(drive=drive), varied=False)
    assert found["pen_per_quadrant"].score == 10
    assert "Of the four quadrants 2 were entered" in str(found["pen_per_quadrant"].rationale)
    assert total(found) < 55
    circles = spoiled(drive=lambda self, tick, arena: twist(arena, 0.51, 1.5))
    found = verdicts(circles, varied=False)["pen_per_quadrant"]
    assert str(found.help).startswith("Look at the spiral first")
