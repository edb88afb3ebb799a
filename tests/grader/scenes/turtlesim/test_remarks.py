"""A reader of any result is told what was done to the arena other than by driving."""

from dataclasses import replace

import pytest

from grader.scenes.subject import load_subject
from grader.scenes.turtlesim.trace import TurtleTrace
from grader.scenes.turtlesim.words import remarks
from tests import archive
from tests.grader.driving import Spiral, drive
from turtlesim_py.world.events import (
    Clear,
    Kill,
    Reset,
    SetPen,
    Spawn,
    TeleportAbsolute,
    TeleportRelative,
)

MOVES = "it moves a turtle without driving"


@pytest.fixture(scope="module")
def trace():
    return TurtleTrace.of(drive(Spiral(), ticks=100).trace)


def told(trace):
    return [str(remark) for remark in remarks(trace, [])]


def test_there_is_nothing_to_say_about_driving_and_pens(trace):
    assert not list(remarks(trace, ["/turtle1/cmd_vel", "/somewhere/else"]))


def test_the_messages_of_newer_releases_are_named_and_the_older_are_not(trace):
    assert not [*remarks(trace, [], "turtlesim"), *remarks(trace, [], "")]
    (said,) = remarks(trace, [], "turtlesim_msgs")
    assert "run with the messages of turtlesim_msgs: ROS 2 has them from Kilted on" in str(said)


@pytest.mark.parametrize(
    ("event", "at_s", "effect"),
    [
        (TeleportAbsolute(tick=100, x=1.0, y=2.0, theta=0.0), "1.60", MOVES),
        (TeleportRelative(tick=100, turtle="b", linear=1.0, angular=0.0), "1.60", MOVES),
        (Spawn(tick=1, x=1.0, y=2.0, theta=0.0, name=""), "0.02", "it adds a turtle"),
        (Kill(tick=50, name="nobody"), "0.80", "it removes a turtle"),
        (Reset(tick=50), "0.80", "it starts the arena anew"),
        (Clear(tick=50), "0.80", "it wipes the drawing"),
    ],
)
def test_an_intervention_is_told_with_its_time_and_effect(trace, event, at_s, effect):
    said = f"The node called {event.op} once, first at {at_s} s: {effect}."
    assert told(replace(trace, events=(*trace.events, event))) == [said]


def test_many_are_one_sentence_with_their_number_and_the_first_time(trace):
    many = tuple(Clear(tick=tick) for tick in (25, 50, 75))
    assert told(replace(trace, events=many)) == [
        "The node called clear 3 times, first at 0.40 s: it wipes the drawing."
    ]


def test_a_node_that_publishes_the_pose_itself_is_told_what_was_judged(trace):
    (said,) = remarks(trace, ["/turtle1/pose"])
    assert str(said).startswith("The node published on /turtle1/pose itself.")
    assert "where the turtle really was" in str(said)


def test_a_pen_of_width_0_draws_and_says_so(trace):
    pens = [SetPen(tick=tick, r=1, g=2, b=3, width=0, off=off) for tick, off in ((10, 1), (50, 0))]
    assert told(replace(trace, events=(*trace.events, *pens))) == [
        "The pen's width is 0, first at 0.80 s: that draws like width 1; what lifts the pen is "
        "off = 1."
    ]
    assert told(replace(trace, events=(*trace.events, pens[0]))) == []


def test_what_a_peer_calls_is_not_said_of_the_node():
    recording = archive.recordings("tf2_broadcaster", "right").nominal
    assert TurtleTrace.of(recording.trace).of_kind(TeleportAbsolute)
    assert load_subject(recording.scene).remarks(recording) == []
