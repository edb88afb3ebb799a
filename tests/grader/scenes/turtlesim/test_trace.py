"""What a trace of turtlesim tells when it is asked."""

from dataclasses import replace

import numpy as np
import pytest

from grader.scenes.turtlesim.trace import Log, TurtleTrace
from tests.grader.driving import Spiral, drive
from turtlesim_py.world.events import CmdVel, Kill, Spawn


@pytest.fixture(scope="module")
def trace():
    return TurtleTrace.of(drive(Spiral(), ticks=100).trace)


def test_the_hash_knows_every_pose_and_every_input_and_nothing_else(trace):
    first = trace.trajectory()
    moved = replace(first, x=np.nextafter(first.x, np.inf))
    for other in (
        replace(trace, trajectories={"turtle1": moved}),
        replace(trace, trajectories={"turtle2": first}),
        replace(trace, events=trace.events[:-1]),
        replace(trace, events=trace.events[::-1]),
    ):
        assert other.sha256() != trace.sha256()
    for same in (
        replace(trace, logs=()),
        replace(trace, window=trace.window[::-1], canvas=trace.canvas[::-1]),
    ):
        assert same.sha256() == trace.sha256()


def test_the_hash_does_not_hang_on_the_order_in_which_turtles_appeared(trace):
    way = trace.trajectory()
    one, other = (dict.fromkeys(names, way) for names in ("ab", "ba"))
    assert replace(trace, trajectories=one).sha256() == replace(trace, trajectories=other).sha256()


def test_inputs_are_found_by_kind_and_turtle(trace):
    zero = (0.0, 0.0, 0.0)
    mine = CmdVel(tick=1, linear=zero, angular=zero)
    its = CmdVel(tick=2, turtle="another", linear=zero, angular=zero)
    spawn = Spawn(tick=2, x=1.0, y=2.0, theta=0.0, name="another")
    made = replace(trace, events=(mine, spawn, its))
    assert made.of_kind(CmdVel) == [mine]
    assert made.of_kind(CmdVel, "another") == [its]
    assert made.of_kind(Spawn) == made.of_kind(Spawn, "nobody") == [spawn]
    assert made.of_kind(Kill) == []


def test_a_turtle_that_never_was_has_an_empty_trajectory(trace):
    way = trace.trajectory("nobody")
    assert len(way) == 0
    assert way.rgb.shape == (0, 3)


def test_another_scene_s_trace_is_refused():
    with pytest.raises(TypeError, match="expected a TurtleTrace, found a Log"):
        TurtleTrace.of(Log(1, "INFO", "turtlesim", "no trace"))
