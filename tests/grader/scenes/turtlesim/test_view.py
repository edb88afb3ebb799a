"""What a page shows of a run: ways in pixels, pens, curves, calls, and the place of rest."""

import re
from dataclasses import replace

import numpy as np
import pytest

from grader.scenes.turtlesim.trace import TurtleTrace
from grader.scenes.turtlesim.view import PLANE, view
from grader.scenes.view import PenChange
from grader.text.message import NOTHING
from tests.grader.driving import GREEN, RED, Spiral, drive, pen, twist
from turtlesim_py.world.arena import TICK_NS, Arena
from turtlesim_py.world.turtle import SIZE_M, TICK_S


def once(at_tick, act):
    return lambda tick, _, arena: act(arena) if tick == at_tick else None


def traced(controller, ticks=4000):
    return TurtleTrace.of(drive(controller, ticks=ticks).trace)


@pytest.fixture(scope="module")
def spiral():
    return traced(Spiral())


def test_metres_become_pixels_with_y_down():
    assert PLANE.to_px(0, 0) == (0, pytest.approx(499, abs=1e-4))
    assert PLANE.to_px(SIZE_M, SIZE_M) == (pytest.approx(499, abs=1e-4), 0)


def test_a_track_has_every_tick_in_the_pixels_of_the_picture(spiral):
    way = spiral.trajectory()
    (track,) = view(spiral).tracks
    assert track.name == "turtle1"
    assert np.array_equal(track.times_ns, way.ticks * TICK_NS)
    for x, y, place in zip(way.x, way.y, zip(track.x, track.y, strict=True), strict=True):
        assert place == PLANE.to_px(x, y)
    assert np.array_equal(track.theta, way.theta)


def test_the_turtle_of_the_exercise_comes_first_then_the_others_by_name():
    def controller(tick, pose, arena):
        for name in ("zoe", "ada"):
            if tick == 2:
                arena.spawn(2.0, 3.0, 0.0, name)

    shown = view(traced(controller, ticks=9))
    assert [track.name for track in shown.tracks] == ["turtle1", "ada", "zoe"]
    assert shown.tracks[1].times_ns.tolist() == [tick * TICK_NS for tick in range(2, 10)]


def test_without_turtle1_the_first_that_appeared_takes_its_place(spiral):
    way = spiral.trajectory()
    shown = view(replace(spiral, trajectories={"other": way, "zoe": way, "ada": way}))
    assert [track.name for track in shown.tracks] == ["other", "ada", "zoe"]
    assert shown.rest is not None
    assert len(shown.curves) == 4


def test_a_pen_that_is_lifted_keeps_its_colour_and_width_until_it_gets_others():
    def controller(tick, pose, arena):
        if tick == 100:
            pen(arena, RED, 5)
        if tick == 200:
            arena.set_pen("turtle1", 9, 9, 9, 9, 1)
        if tick == 300:
            pen(arena, GREEN)

    (track,) = view(traced(controller, ticks=400)).tracks
    assert track.pens == (
        PenChange(0, "#b3b8ff", 3),
        PenChange(100 * TICK_NS, "#ff0000", 5),
        PenChange(200 * TICK_NS, "#ff0000", 5, drawn=False),
        PenChange(300 * TICK_NS, "#00ff00", 3),
    )


def test_a_pen_belongs_to_its_turtle():
    def controller(tick, pose, arena):
        if tick == 1:
            arena.spawn(2.0, 3.0, 0.0, "another")
            arena.set_pen("another", 1, 2, 3, 4, 0)

    first, second = view(traced(controller, ticks=9)).tracks
    assert len(first.pens) == 1
    assert second.pens[1:] == (PenChange(TICK_NS, "#010203", 4),)


def test_clearing_and_resetting_make_what_was_drawn_vanish():
    for act in (Arena.clear, Arena.reset):
        assert view(traced(once(50, act), ticks=100)).cleared == (50 * TICK_NS,)


def test_the_rest_is_where_and_since_when_it_stands_still(spiral):
    rest = view(spiral).rest
    way = spiral.trajectory()
    assert (rest.x, rest.y) == (way.x[-1], way.y[-1])
    moved_last = np.flatnonzero(np.diff(way.x) != 0)[-1] + 1
    assert rest.time_s == pytest.approx(way.ticks[moved_last] * TICK_S)
    assert min(rest.x, rest.y, SIZE_M - rest.x, SIZE_M - rest.y) < 0.5


def test_what_still_moves_never_moved_or_is_nowhere_has_no_rest(spiral):
    assert view(traced(Spiral(), ticks=300)).rest is None
    assert view(traced(lambda *_: None, ticks=10)).rest is None
    rows = spiral.trajectory().rows()
    rows[100:, 1:3] = np.nan
    lost = type(spiral.trajectory()).of_rows(rows)
    assert view(replace(spiral, trajectories={"turtle1": lost})).rest is None


def test_there_is_a_curve_for_distance_speed_turning_and_command_rate(spiral):
    way = spiral.trajectory()
    distance, speed, turning, rate = view(spiral).curves
    assert [(str(c.title), c.unit) for c in (distance, speed, turning, rate)] == [
        ("Distance from the centre of the window", "m"),
        ("Speed", "m/s"),
        ("Angular velocity", "rad/s"),
        ("Rate of velocity commands", "Hz"),
    ]
    assert distance.values == pytest.approx(np.hypot(way.x - SIZE_M / 2, way.y - SIZE_M / 2))
    assert np.array_equal(speed.values, way.linear)
    assert np.array_equal(turning.values, way.angular)
    for curve in (distance, speed, turning):
        assert np.array_equal(curve.times_ns, way.ticks * TICK_NS)
    assert np.array_equal(rate.times_ns, np.arange(1, spiral.ticks + 1) * TICK_NS)


def test_the_rate_of_a_command_every_31_ticks_is_2_hz_and_nothing_after_the_last(spiral):
    rate = view(spiral).curves[3].values
    assert rate[1:1000] == pytest.approx(np.full(999, 1 / (31 * TICK_S)))
    assert rate[0] == 0  # the first command ends no interval
    assert rate[-1] == 0


def test_several_commands_of_one_tick_count_in_full():
    def controller(tick, pose, arena):
        for _ in range(3 if tick % 10 == 0 else 0):
            twist(arena, 1.0)

    rate = view(traced(controller, ticks=59)).curves[3].values
    assert rate[10:50] == pytest.approx(np.full(40, 3 / (10 * TICK_S)))
    assert rate[:10].tolist() == [0.0] * 10
    assert rate[50:].tolist() == [0.0] * 9


def test_every_input_but_driving_is_a_call_and_a_pen_s_has_its_colour(spiral):
    calls = view(spiral).calls
    assert {call.name for call in calls} == {"set_pen"}
    assert {call.color for call in calls} == {"#ffffff", "#ff0000", "#00ff00", "#0000ff"}

    def clears(arena):
        arena.clear()
        twist(arena, 1.0)

    (cleared,) = view(traced(once(3, clears), ticks=9)).calls
    assert (cleared.name, cleared.time_ns, cleared.color) == ("clear", 3 * TICK_NS, "")


def test_a_call_says_what_it_asked_for_and_where_the_turtle_was(spiral):
    first, second, third, *_ = [(str(call.text), str(call.where)) for call in view(spiral).calls]
    assert first == ("white (255, 255, 255), 3 px", "top right (quadrant I)")
    assert second == ("red (255, 0, 0), 3 px", "top left (quadrant II)")
    assert third == ("green (0, 255, 0), 3 px", "bottom left (quadrant III)")


def test_a_call_for_a_turtle_that_never_was_has_no_place():
    (cleared,) = view(traced(once(1, lambda arena: arena.clear()), ticks=2)).calls
    assert (cleared.text, cleared.where) == (NOTHING, NOTHING)


def test_the_picture_is_told_in_words(spiral):
    said = [str(part) for part in view(spiral).drawn]
    assert [part.split(" (")[0] for part in said] == [
        "top right",
        "top left",
        "bottom left",
        "bottom right",
    ]
    for part, color in zip(said, ("white", "red", "green", "blue"), strict=True):
        assert re.search(rf": mostly {color} \([\d, ]+\), \d,\d+ pixels$", part)


def test_the_background_is_what_lies_below_the_ink_or_the_usual_one(spiral):
    assert view(traced(Spiral(), ticks=200)).background == "#4556ff"
    other = once(1, lambda arena: arena.set_parameter("background_r", 255))
    assert view(traced(other, ticks=2)).background == "#ff56ff"
    painted = replace(spiral, canvas=np.full_like(spiral.canvas, 255))
    assert view(painted).background == "#4556ff"


def test_an_empty_trace_has_an_empty_view(spiral):
    shown = view(replace(spiral, ticks=0, events=(), trajectories={}))
    assert (shown.tracks, shown.cleared, shown.rest) == ((), (), None)
    assert (shown.curves, shown.calls) == ((), ())
    assert len(shown.drawn) == 4
