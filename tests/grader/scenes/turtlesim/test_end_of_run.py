"""A run is over when there is nothing more to see, and the reason says why."""

import pytest

from grader.scenes.scene import Limits
from grader.scenes.turtlesim.simulation import GRACE_TICKS, EndOfRun
from turtlesim_py.world.turtle import TICK_S, Pose

#: In ticks: nothing moved by 100, rested for 10, 200 at most.
FIRST_MOTION, REST, TOTAL = 100, 10, 200
LIMITS = Limits(first_motion_s=100 * TICK_S, rest_s=10 * TICK_S, total_s=200 * TICK_S)


def at(x, theta=0.0, speed=0.0):
    return Pose(x, 5.0, theta, speed, 0.0)


def turtles(pose):
    return {} if pose is None else {"turtle1": pose}


def ends(poses, limits=LIMITS, gone_tick=None):
    """The tick after which a run of these poses (tick -> pose) is over, and why."""
    end = EndOfRun(limits)
    for tick in range(1, 1000):
        reason = end.after(tick, turtles(poses(tick)), gone_tick)
        if reason:
            return tick, reason
    raise AssertionError("it never ends")


def pauses(tick):
    return at(tick if tick < 20 else max(20, tick - REST + 2))


def turns_then_drives(tick):
    return at(1.0 + min(max(tick - 60, 0), 20), theta=min(tick, 30))


@pytest.mark.parametrize(
    ("poses", "end", "why"),
    [
        (lambda tick: at(1.0), FIRST_MOTION, "no_motion"),
        (lambda tick: None, FIRST_MOTION, "no_motion"),  # there never was a turtle
        (lambda tick: at(1.0, speed=float(tick)), FIRST_MOTION, "no_motion"),  # only published
        (lambda tick: at(min(tick, 50)), 50 + REST, "rest"),
        (lambda tick: at(1.0 + (tick > 98)), 99 + REST, "rest"),
        (lambda tick: at(tick) if tick < 20 else None, 19 + REST, "rest"),  # it was killed
        (turns_then_drives, 80 + REST, "rest"),
        (lambda tick: at(1.0, theta=min(tick, 30)), 30 + FIRST_MOTION, "rest"),
        (lambda tick: at(tick), TOTAL, "time_limit"),
        (lambda tick: at(max(tick, 98)), TOTAL, "time_limit"),
        (lambda tick: at(1.0, theta=tick), TOTAL, "time_limit"),
        (pauses, TOTAL, "time_limit"),
        # numbers of their own, as a turtle makes them: it is never where it was
        (lambda tick: at(float("nan")), TOTAL, "time_limit"),
    ],
)
def test_a_run_is_over_with_the_first_motion_due_the_rest_or_the_time(poses, end, why):
    assert ends(poses) == (end, why)


def test_the_time_limit_goes_before_everything_else():
    limits = Limits(first_motion_s=TICK_S, rest_s=TICK_S, total_s=TICK_S)
    assert ends(lambda tick: at(1.0), limits, gone_tick=0) == (1, "time_limit")


def test_what_a_submission_that_is_gone_has_left_is_seen_to_its_end():
    assert ends(lambda tick: at(1.0), gone_tick=5) == (5 + GRACE_TICKS, "gone")
    assert ends(lambda tick: at(min(tick, 50)), gone_tick=0) == (50 + REST, "rest")


def test_being_at_rest_needs_a_motion_before():
    end = EndOfRun(LIMITS)
    seen = []
    for tick, x in enumerate((1, 1, 2, 2, 3), 1):
        end.after(tick, turtles(at(x)))
        seen.append(end.is_at_rest)
    assert seen == [False, False, False, True, False]
