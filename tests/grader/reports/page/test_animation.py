import numpy as np
import pytest

from grader.reports.page.animation import animation, svg_path
from grader.scenes.turtlesim.trace import TurtleTrace
from grader.scenes.turtlesim.view import view
from tests.grader.driving import GREEN, RED, Spiral, drive, pen, twist
from turtlesim_py.world.turtle import SIZE_M, TICK_S


def animation_of(recording):
    return animation(view(recording.trace), recording.trace.duration_ns)


def test_a_line_is_interrupted_where_a_place_is_missing():
    x = np.array([1, 2, np.nan, 4, 5.26])
    assert svg_path(x, np.ones(5)) == "M1 1L2 1M4 1L5.3 1"


def test_a_long_run_is_thinned_out_and_keeps_its_end():
    recording = drive(Spiral())
    shown = animation_of(recording)
    (track,) = shown.tracks
    assert 500 < len(shown.times) <= 1001
    assert shown.times[-1] == pytest.approx(recording.run.ticks * TICK_S)
    assert track.x[-1] == pytest.approx(
        TurtleTrace.of(recording.trace).trajectory().x[-1] * 45, abs=0.01
    )


def test_ink_has_the_pens_colour_and_gaps_where_it_was_off():
    def controller(tick, pose, arena):
        if tick % 30 == 1:
            twist(arena, 1.0)
        if tick == 100:
            pen(arena, RED, 5)
        if tick == 200:
            arena.set_pen("turtle1", 0, 0, 0, 0, 1)
        if tick == 300:
            pen(arena, GREEN)

    (track,) = animation_of(drive(controller, ticks=400)).tracks
    found = [(*at, pen.color, pen.width, pen.drawn) for *at, pen in track.stretches]
    assert found == [
        (0, 98, "#b3b8ff", 3, True),
        (98, 198, "#ff0000", 5, True),
        (198, 298, "#ff0000", 5, False),
        (298, 399, "#00ff00", 3, True),
    ]
    assert track.lifted().count("M") == 1


def test_other_turtles_are_drawn_from_when_they_are_there_and_what_was_cleared_is_known():
    def controller(tick, pose, arena):
        if tick == 50:
            arena.spawn(2.0, 3.0, 0.0, "another")
            arena.clear()

    shown = animation_of(drive(controller, ticks=100))
    assert (shown.view.background, shown.cleared) == ("#4556ff", (49,))
    _, second = shown.tracks
    assert np.isnan(second.x[:48]).all()
    assert second.x[-1] == pytest.approx(90)


def test_the_rest_is_where_the_turtle_stands_at_the_end():
    rest = animation_of(drive(Spiral())).view.rest
    assert min(rest.x, rest.y, SIZE_M - rest.x, SIZE_M - rest.y) < 0.5
    assert rest.time_s > 30
    assert animation_of(drive(Spiral(), ticks=300)).view.rest is None
    assert animation_of(drive(lambda *_: None, ticks=10)).view.rest is None
