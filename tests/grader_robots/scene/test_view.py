"""The robot is shown where tf says that its links are; what has no place is told."""

import math

import numpy as np
import pytest

from grader_robots.robot_py.robot_state import Placed
from grader_robots.scene import view
from grader_robots.scene.driving import drive, joint_state, tf
from grader_robots.scene.scene import SCENE
from grader_robots.scene.trace import TF, TICK_NS, RobotTrace
from tests.grader_robots.scene.robots import walks

URDF = """<robot name="two"><material name="m"><color rgba="0 0 1 1"/></material>
  <link name="axis"><visual><geometry><box size="1 .5 .5"/></geometry><material name="m"/></visual>
  </link>
  <link name="body"><visual><geometry><sphere radius=".2"/></geometry></visual></link>
  <joint name="turn" type="continuous"><parent link="axis"/><child link="body"/>
    <origin xyz="0 0 .5"/><axis xyz="0 0 1"/></joint></robot>"""
TICKS = 400


@pytest.fixture(scope="module")
def walk():
    return drive(walks, TICKS, URDF)


def shown(trace):
    made = view.solid(trace)
    assert made is not None
    return made


def test_links_are_where_the_transforms_put_them(walk):
    places = view.places(walk)
    angle = TICKS / 100
    assert places["axis"][:3, 3] == pytest.approx([math.cos(angle), math.sin(angle), 0.5])
    assert places["body"][:3, 3] == pytest.approx([math.cos(angle), math.sin(angle), 1.0])
    # it looks where it goes
    assert places["axis"][:2, 0] == pytest.approx([-math.sin(angle), math.cos(angle)])


def test_a_solid_has_a_placing_for_each_sample_of_what_moves(walk):
    made = shown(walk)
    assert [(frame.name, frame.parent) for frame in made.frames] == [("axis", -1), ("body", 0)]
    assert made.times_ns[-1] == TICKS * TICK_NS and len(made.times_ns) <= view.SAMPLES
    axis = made.frames[0].placings
    assert len(axis) == len(made.times_ns)
    assert axis[1] is not None and axis[-1] is not None and axis[1].at != axis[-1].at
    assert [(s.kind, s.color, s.frame) for s in made.shapes] == [
        ("box", "#0000ff", 0),
        ("sphere", "#ff0000", 1),
    ]
    assert made.lost == ()
    assert str(made.text).startswith("The robot two with 2 links: axis, body; at (")
    assert "about a circle of 1.00 m" in str(made.text)


def test_before_the_first_transform_a_frame_has_no_placing():
    def late(tick, now_ns):
        return walks(tick, now_ns) if tick > 200 else ()

    placings = shown(drive(late, TICKS, URDF)).frames[0].placings
    assert placings[0] is None and placings[-1] is not None


def test_what_no_transform_leads_to_is_named_and_at_the_origin():
    def without_joints(tick, now_ns):
        return walks(tick, now_ns)[1:]

    trace = drive(without_joints, TICKS, URDF)
    made = shown(trace)
    assert made.lost == ("body",)
    assert made.frames[-1].placings == (None,)
    assert "for want of a transform: body" in str(made.text)
    assert list(view.places(trace)) == ["axis"]


@pytest.mark.parametrize("turned", [(0.0, 0.0, 0.0, 5e-324), (0.0, 0.0, 0.0, 1e300)])
def test_a_quaternion_that_turns_nothing_gives_no_picture_that_fails(turned):
    def odd(tick, now_ns):
        return (tf(Placed(now_ns, "odom", "axis", (1e300, -1e300, 0.0), turned)),)

    trace = drive(odd, 20, URDF)
    assert "axis" in shown(trace).lost
    assert view.plan(trace).shape == (500, 500, 3)


def test_a_recording_of_nothing_still_has_its_picture():
    assert SCENE.pictures(RobotTrace(0)).window.shape == (500, 500, 3)
    made = SCENE.view(RobotTrace(0))
    assert (made.parts, made.tracks, made.curves) == ((), (), ())
    assert str(made.drawn[0]) == "no robot description was recorded"


def test_a_way_far_out_and_a_great_circle_do_no_harm():
    def far(tick, now_ns):
        at = (900.0 * math.cos(tick / 1e4), 900.0 * math.sin(tick / 1e4), 0.0)
        said = Placed(now_ns, "odom", "axis", at, (0.0, 0.0, 0.0, 1.0))
        return joint_state(now_ns, ["turn"], [0.0]), tf(said, topic=TF)

    trace = drive(far, 100, URDF)
    assert np.isfinite(view.way(trace)).all()
    assert view.plan(trace).shape == (500, 500, 3)


def test_the_curve_of_the_way_is_measured_from_its_circle(walk):
    curves = {curve.title: curve for curve in SCENE.view(walk).curves}
    assert curves[view.FROM_CENTRE].values == pytest.approx(1.0)
    assert view.curve_of("turn") in curves
