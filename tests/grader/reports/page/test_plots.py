import re
from dataclasses import replace

import numpy as np
import pytest

from grader.reports.page.plots import HEIGHT, WIDTH, plots
from grader.scenes.turtlesim.trace import TurtleTrace
from grader.scenes.turtlesim.view import view
from grader.scenes.view import Curve, View
from grader.text.message import Message
from tests.grader.driving import Spiral, drive, pen
from turtlesim_py.world.arena import TICK_NS
from turtlesim_py.world.turtle import TICK_S


def plots_of(recording, **columns):
    """The plots of a recording, in which some columns of turtle1 are others."""
    trace = TurtleTrace.of(recording.trace)
    changed = replace(trace.trajectory(), **columns)
    return plots(view(replace(trace, trajectories={"turtle1": changed})), trace.duration_ns)


@pytest.fixture(scope="module")
def shown():
    return plots_of(drive(Spiral()))


def heights(plot):
    return [float(y) for _, y in re.findall(r"[ML]([-\d.e+]+) ([-\d.e+]+)", plot.path)]


def test_there_is_a_curve_for_distance_speed_turning_and_command_rate(shown):
    assert [(c.title, c.unit) for c in shown.curves] == [
        ("Distance from the centre of the window", "m"),
        ("Speed", "m/s"),
        ("Angular velocity", "rad/s"),
        ("Rate of velocity commands", "Hz"),
    ]


def test_the_rate_of_a_command_every_31_ticks_is_2_hz(shown):
    rate = shown.curves[3]
    top = float(rate.ticks[-1].label)
    values = [top * (1 - y / HEIGHT) for y in heights(rate)]
    assert values.count(pytest.approx(1 / (31 * TICK_S), abs=0.01)) >= 2
    assert values[-1] == pytest.approx(0)


def test_curves_stay_in_their_box_and_are_thinned_out(shown):
    for curve in shown.curves:
        assert all(-0.1 <= y <= HEIGHT + 0.1 for y in heights(curve))
        assert len(curve.path) < 30_000
        assert float(re.findall(r"[ML]([\d.]+) ", curve.path)[-1]) <= WIDTH


def test_a_spike_of_one_tick_survives_the_thinning():
    recording = drive(Spiral())
    linear = TurtleTrace.of(recording.trace).trajectory().linear.copy()
    linear[1233:1235] = np.nan, 77.0  # a neighbour without a value does not hide it
    speed = plots_of(recording, linear=linear).curves[1]
    assert min(heights(speed)) == pytest.approx(
        (1 - 77 / float(speed.ticks[-1].label)) * 100, abs=1
    )


def test_service_calls_are_counted_keep_their_colours_and_are_listed_in_words(shown):
    (calls,) = shown.calls
    assert calls.name == "set_pen"
    assert {mark.color for mark in calls.marks} == {"#ffffff", "#ff0000", "#00ff00", "#0000ff"}
    assert calls.count == len(calls.marks)
    assert calls.has_text and calls.has_place
    assert str(calls.rows[1].text).startswith("red (255, 0, 0)")
    assert str(calls.rows[1].where) == "top left (quadrant II)"


def test_a_flood_of_calls_is_counted_in_full_and_drawn_sparsely():
    recording = drive(lambda tick, pose, arena: pen(arena, (tick % 256, 0, 0)), ticks=900)
    (calls,) = plots_of(recording).calls
    assert calls.count == 900
    assert len(calls.marks) <= 401
    assert len(calls.rows) == 12
    assert calls.rows[1].time_ns / 1e9 == pytest.approx(2 * TICK_S)


def test_values_without_end_do_not_break_a_plot():
    recording = drive(Spiral(), ticks=500)
    way = TurtleTrace.of(recording.trace).trajectory()
    linear, angular = way.linear.copy(), way.angular.copy()
    linear[100], linear[200], angular[300] = np.inf, np.nan, 1e30
    shown = plots_of(recording, linear=linear, angular=angular)
    assert "nan" not in shown.curves[1].path
    assert shown.curves[2].summary.endswith("1e+30 rad/s")


def test_nothing_recorded_has_no_plots_and_a_turtle_that_stands_still_flat_ones():
    curve = Curve(Message.of("Speed"), "m/s", np.zeros(0, np.int64), np.zeros(0))
    assert plots(View(), TICK_NS) is None
    assert plots(View(curves=(curve,)), 0) is None
    still = plots_of(drive(lambda *_: None, ticks=900))
    assert still.curves[1].summary == "Speed: from 0 to 0 m/s"
    assert still.calls == ()
