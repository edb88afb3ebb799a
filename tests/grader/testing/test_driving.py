"""A function drives the real world, and what comes out is a recording as of a run."""

import pytest

from grader.recording.subject import Start
from grader.scenes.turtlesim.driving import pen, twist
from grader.scenes.turtlesim.trace import TurtleTrace
from grader.testing import drive
from turtlesim_py.world.events import CmdVel, SetPen


def a_second_ahead(tick, pose, arena):
    if tick == 1:
        assert pose is None
        pen(arena, (1, 2, 3), width=7)
        twist(arena, 1.0, 0.5)
    else:
        assert pose is not None


def test_a_recording_holds_what_was_driven_and_how_it_ended():
    recording = drive(a_second_ahead, output="hello\n")
    trace = TurtleTrace.of(recording.trace)
    assert recording.run.outcome == "finished"
    assert recording.run.ticks == trace.ticks == len(trace.trajectory())
    assert recording.run.trace_sha256 == trace.sha256()
    assert recording.output == "hello\n"
    assert [type(event) for event in trace.events] == [SetPen, CmdVel]
    assert drive(a_second_ahead).run.trace_sha256 == recording.run.trace_sha256


def test_it_may_be_cut_short_start_elsewhere_go_and_come_back():
    start = Start(2.0, 3.0, 0.5)
    recording = drive(a_second_ahead, ticks=10, start=start)
    assert (recording.run.outcome, recording.run.ticks) == ("time_limit", 10)
    assert recording.start == start
    assert TurtleTrace.of(recording.trace).trajectory().x[0] == pytest.approx(2.0, abs=0.1)

    def kills(tick, pose, arena):
        if tick == 5:
            arena.kill("turtle1")
        if tick == 8:
            assert pose is None
            arena.spawn(1.0, 1.0, 0.0, "turtle1")

    ticks = TurtleTrace.of(drive(kills, ticks=10).trace).trajectory().ticks
    assert ticks.tolist() == [1, 2, 3, 4, 8, 9, 10]
