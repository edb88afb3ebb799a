"""A robot that is moved in this way or that gets the verdict that it deserves; no ROS is needed."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.packaged import LaunchDescription, LaunchedNode, Packaged
from grader.recording.recording import Recording, Recordings
from grader.scenes.robot.driving import drive, joint_state, tf
from robot_py.robot_state import Placed

EXERCISE = load_exercise("state_publisher")
ROBOT = LaunchedNode("robot_state_publisher", "robot_state_publisher", ("robot_description",))
OWN = LaunchedNode("walker", "state_publisher", ())
LAUNCH = LaunchDescription("walker.launch.py", nodes=(ROBOT, OWN))
PACKAGED = Packaged("walker", ("state_publisher",), "state_publisher", launches=(LAUNCH,))


def walker(every=2, radius=2.0, speed=0.5, height=0.7, look=math.pi / 2, joints=lambda t: {}):
    """Publishes every so many ticks."""

    def controller(tick, now_ns):
        if tick % every:
            return ()
        t = tick * 0.016
        moved = {
            "swivel": 0.5 * t,
            "tilt": 0.3 * math.sin(t),
            "periscope": 0.1 * math.sin(t),
            **joints(t),
        }
        angle = speed * t
        half = (angle + look * math.copysign(1, speed)) / 2
        at = (radius * math.cos(angle), radius * math.sin(angle), height)
        turned = (0.0, 0.0, math.sin(half), math.cos(half))
        return (
            joint_state(now_ns, list(moved), list(moved.values())),
            tf(Placed(now_ns, "odom", "axis", at, turned)),
        )

    return controller


def lost(controller, packaged=PACKAGED, ticks=1000):
    """The checks that lose points, with the share that is left."""
    trace = drive(controller, ticks, EXERCISE.setting)
    recording = Recording(trace, scene="robot", packaged=packaged)
    found = judge(Recordings(recording), EXERCISE.checks, EXERCISE.points, EXERCISE.tolerances)
    return {v.check: round(v.share, 2) for v in found if not v.passed}


@pytest.mark.parametrize(
    "controller",
    [
        walker(),
        walker(every=6, radius=0.5, speed=-0.4, height=0.4),
        walker(every=1, radius=4.0, speed=1.0),
        walker(joints=lambda t: {"swivel": math.remainder(-3 * t, math.tau)}),
        walker(joints=lambda t: {"tilt": -2.0 + 0.3 * math.sin(t)}),  # beyond the URDF's limits
    ],
)
def test_shape_and_relation_count_and_no_numbers(controller):
    assert lost(controller) == {}


@pytest.mark.parametrize(
    ("controller", "losses"),
    [
        (walker(every=40), {"publishes": 0}),
        (walker(look=0.0), {"odometry": 0.7}),
        (walker(look=-math.pi / 2), {"odometry": 0.7}),
        (walker(radius=200.0), {"odometry": 0.65}),
        (walker(height=0.0), {"odometry": 0.85}),
        (walker(joints=lambda t: {"tilt": 17 * math.sin(t)}), {"joints_move": 0.67}),
        (walker(joints=lambda t: {"periscope": 0.0}), {"joints_move": 0.67}),
        (walker(joints=lambda t: {"swivel": math.sin(t)}), {"joints_move": 0.67}),
        (walker(joints=lambda t: {"swivel": 30.0 * t}), {"joints_move": 0.67}),
        (walker(joints=lambda t: {"wheel": 1.0}), {"joint_names": 0.75}),
    ],
)
def test_each_mistake_loses_what_it_should(controller, losses):
    assert lost(controller) == losses


@pytest.mark.parametrize(
    ("packaged", "losses"),
    [
        (None, {"package": 0, "launch": 0}),
        (replace(PACKAGED, launches=()), {"launch": 0}),
        (replace(PACKAGED, shortcomings=("no setup.cfg",)), {"package": 0.5}),
        (replace(PACKAGED, started="", shortcomings=("no console script",)), {"package": 0}),
        (replace(PACKAGED, not_installed=("urdf/a.urdf",)), {"launch": 0.8}),
    ],
)
def test_a_package_is_judged_by_what_it_says_of_itself(packaged, losses):
    assert lost(walker(), packaged) == losses


@pytest.mark.parametrize(
    ("launch", "losses"),
    [
        (LaunchDescription("a.launch.py", fault="it does not parse"), {"launch": 0}),
        (replace(LAUNCH, nodes=(OWN,)), {"launch": 0.6}),
        (replace(LAUNCH, nodes=(OWN,), includes=True), {}),
        (replace(LAUNCH, nodes=(ROBOT,)), {"launch": 0.6}),
        (replace(LAUNCH, nodes=(replace(ROBOT, parameters=None), OWN)), {}),
        (replace(LAUNCH, nodes=(replace(ROBOT, parameters=()), OWN)), {"launch": 0.6}),
        (replace(LAUNCH, nodes=(ROBOT, replace(OWN, package=None))), {}),
        (replace(LAUNCH, nodes=(ROBOT, replace(OWN, package="other"))), {"launch": 0.6}),
        (
            replace(LAUNCH, nodes=(ROBOT, OWN, LaunchedNode("j", "joint_state_publisher_gui"))),
            {"launch": 0.6},
        ),
        (replace(LAUNCH, absolute=("/home/me/a.urdf",)), {"launch": 0.8}),
    ],
)
def test_a_launch_file_starts_robot_and_node_and_what_is_computed_is_right(launch, losses):
    assert lost(walker(), replace(PACKAGED, launches=(launch,))) == losses


def test_of_several_launch_files_the_best_counts():
    bad = LaunchDescription("a.launch.py", fault="it does not parse")
    assert lost(walker(), replace(PACKAGED, launches=(bad, LAUNCH))) == {}
