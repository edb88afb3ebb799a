"""A run is over when there is nothing more to see, and the reason says why."""

from __future__ import annotations

from grader.scenes.scene import Limits
from grader.scenes.turtlesim.simulation import GRACE_TICKS, EndOfRun
from turtlesim_py.world.turtle import TICK_S, Pose

#: In ticks: nothing moved by 100, rested for 10, 200 at most.
FIRST_MOTION, REST, TOTAL = 100, 10, 200
LIMITS = Limits(first_motion_s=100 * TICK_S, rest_s=10 * TICK_S, total_s=200 * TICK_S)


def at(x: float, theta: float = 0.0, speed: float = 0.0) -> Pose:
    return Pose(x, 5.0, theta, speed, 0.0)


def turtles(pose: Pose | None) -> dict[str, Pose]:
    """The turtles that there are in a tick, by name."""
    return {} if pose is None else {"turtle1": pose}


def ends(poses, limits: Limits = LIMITS, gone_tick: int | None = None) -> tuple[int, str]:
    """The tick after which a run of these poses (tick -> pose) is over, and why."""
    end = EndOfRun(limits)
    for tick in range(1, 1000):
        reason = end.after(tick, turtles(poses(tick)), gone_tick)
        if reason:
            return tick, reason
    raise AssertionError("it never ends")


def test_what_never_moves_is_over_when_the_first_motion_is_due():
    assert ends(lambda tick: at(1.0)) == (FIRST_MOTION, "no_motion")


def test_what_moves_and_rests_is_over_after_the_rest():
    assert ends(lambda tick: at(min(tick, 50))) == (50 + REST, "rest")


def test_what_moves_in_the_last_moment_is_not_over():
    assert ends(lambda tick: at(max(tick, 98))) == (TOTAL, "time_limit")
    assert ends(lambda tick: at(1.0 + (tick > 98))) == (99 + REST, "rest")


def test_a_rest_that_is_too_short_counts_for_nothing():
    def pauses(tick: int) -> Pose:
        return at(tick if tick < 20 else max(20, tick - REST + 2))

    assert ends(pauses) == (TOTAL, "time_limit")


def test_turning_on_the_spot_is_motion():
    assert ends(lambda tick: at(1.0, theta=tick)) == (TOTAL, "time_limit")


def test_who_turns_first_may_pause_before_driving():
    def turns_then_drives(tick: int) -> Pose:
        return at(1.0 + min(max(tick - 60, 0), 20), theta=min(tick, 30))

    assert ends(turns_then_drives) == (80 + REST, "rest")
    assert ends(lambda tick: at(1.0, theta=min(tick, 30))) == (30 + FIRST_MOTION, "rest")


def test_a_published_speed_without_motion_is_none():
    assert ends(lambda tick: at(1.0, speed=float(tick))) == (FIRST_MOTION, "no_motion")


def test_what_moves_for_ever_is_over_with_the_time():
    assert ends(lambda tick: at(tick)) == (TOTAL, "time_limit")


def test_the_time_limit_goes_before_everything_else():
    limits = Limits(first_motion_s=TICK_S, rest_s=TICK_S, total_s=TICK_S)
    assert ends(lambda tick: at(1.0), limits, gone_tick=0) == (1, "time_limit")


def test_the_last_commands_of_a_submission_that_is_gone_may_still_arrive():
    assert ends(lambda tick: at(1.0), gone_tick=5) == (5 + GRACE_TICKS, "gone")


def test_a_submission_that_is_gone_may_have_left_something_that_moves():
    assert ends(lambda tick: at(min(tick, 50)), gone_tick=0) == (50 + REST, "rest")


def test_a_turtle_that_is_no_more_stands_still():
    assert ends(lambda tick: at(tick) if tick < 20 else None) == (19 + REST, "rest")


def test_a_turtle_at_not_a_number_is_never_where_it_was():
    lost = (at(float("nan")) for _ in range(TOTAL))  # numbers of their own, as a turtle makes them
    assert ends(lambda tick: next(lost)) == (TOTAL, "time_limit")


def test_a_turtle_that_never_was_never_moved():
    assert ends(lambda tick: None) == (FIRST_MOTION, "no_motion")


def test_being_at_rest_needs_a_motion_before():
    end = EndOfRun(LIMITS)
    seen = []
    for tick, x in enumerate((1, 1, 2, 2, 3), 1):
        end.after(tick, turtles(at(x)))
        seen.append(end.is_at_rest)
    assert seen == [False, False, False, True, False]
