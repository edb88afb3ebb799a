"""A robot that is moved in this way or that gets the verdict that it deserves; no ROS is needed."""

import math
from dataclasses import replace
from functools import cache

import pytest

from grader.exercise.check import judge
from grader.exercise.loading import load_exercise
from grader.recording.recording import Recording, Recordings
from grader.submission.package_trace import (
    Include,
    InstalledScript,
    Lacking,
    LaunchedNode,
    LaunchFile,
    Obstacle,
    PackageTrace,
    Parameter,
    Setup,
)
from grader.text.message import NOTHING, Message
from grader_robots.robot_py.robot_state import Placed
from grader_robots.scene.driving import drive, joint_state, tf

EXERCISE = load_exercise("state_publisher")
URDF = EXERCISE.setting


def described(text):
    return Parameter("robot_description", "", text, True)


def node(package, executable, *parameters):
    return LaunchedNode(package, executable, "", "", (), parameters, (), False)


ROBOT = node("robot_state_publisher", "robot_state_publisher", described(0))
OWN = node("walker", "state_publisher")
LAUNCH = LaunchFile("a.launch.py", None, (ROBOT, OWN), (), (), (), (), (), (), "")
RVIZ = "/prefix/share/walker/rviz/walker.rviz"
SCRIPT = InstalledScript(
    "state_publisher", "walker.state_publisher", "main", NOTHING, "walker/a.py", True
)
SETUP = Setup(
    *("walker", "walker", "", "ament_python", NOTHING, (), None, (), (), (SCRIPT,)),
    *("lib/walker", (), (), ()),
)
PACKAGE = PackageTrace(SETUP, launches=(LAUNCH,), texts=(URDF,))


def walker(
    every=2, radius=2.0, speed=0.5, height=0.7, look=math.pi / 2, joints=lambda t: {}, without=()
):
    """Publishes every so many ticks, without what is taken away."""

    def controller(tick, now_ns):
        if tick % every:
            return ()
        t = tick * 0.016
        moved = {"swivel": 0.5 * t, "tilt": 0.3 * math.sin(t), "periscope": 0.1 * math.sin(t)}
        moved = {name: at for name, at in moved.items() if f"the {name}" not in without} | joints(t)
        angle = speed * t
        half = (angle + look * math.copysign(1, speed)) / 2
        at = (radius * math.cos(angle), radius * math.sin(angle), height)
        turned = (0.0, 0.0, math.sin(half), math.cos(half))
        stamp = 0 if "stamps" in without else now_ns
        sent = joint_state(stamp, list(moved), list(moved.values()))
        way = tf(Placed(stamp, "odom", "axis", at, turned))
        return (sent,) if "the odometry" in without else (sent, way)

    return controller


@cache
def driven(controller):
    return drive(controller, 1000, EXERCISE.setting)


#: Does everything right.
WALKS = walker()


def judged(controller, package):
    recording = Recording(driven(controller), scene="robot", package=package)
    found = judge(Recordings(recording), EXERCISE.checks, EXERCISE.points, EXERCISE.tolerances)
    assert [v.rationale for v in found if "fault of the exercise" in str(v.rationale)] == []
    return found


def lost(controller=WALKS, package=PACKAGE):
    """The checks that lose points, with the share that is left."""
    found = judged(controller, package)
    return {v.check: round(v.score / v.max_score, 2) for v in found if not v.passed}


@pytest.mark.parametrize(
    "controller",
    [
        WALKS,
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


def said(controller, check, package=PACKAGE):
    """What a check says, and its help."""
    found = judged(controller, package)
    return next((str(v.rationale), str(v.help)) for v in found if v.check == check)


def test_who_sends_a_single_transform_is_not_told_that_it_is_another():
    rationale, _ = said(lambda tick, now: WALKS(tick, now) if tick < 4 else (), "odometry")
    assert rationale.startswith("Only 1 transform from 'odom' to 'axis' came on /tf")


def test_joints_that_stand_are_not_told_of_radians():
    still = dict.fromkeys(("swivel", "tilt", "periscope"), 0.0)
    rationale, help_ = said(walker(joints=lambda t: still), "joints_move")
    assert "stays at 0" in rationale and help_.startswith("What makes the position grow")


def test_what_is_wrong_is_not_mixed_with_what_is_right():
    rationale, _ = said(walker(joints=lambda t: {"periscope": 0.0}), "joints_move")
    assert rationale == "'periscope' stays at 0."


def test_a_path_from_the_current_folder_is_called_one():
    lacking = Lacking("file", "/somewhere/urdf/walker.urdf", "", LAUNCH.file)
    package = replace(PACKAGE, launches=(replace(LAUNCH, lacking=(lacking,)),))
    rationale, _ = said(WALKS, "launch", package)
    assert "asks for urdf/walker.urdf, a path from the current folder" in rationale


MISSING = Message.of("there is no module walker.x")
NAME_ERROR = Obstacle("error", Message.of("NameError: x"))


@pytest.mark.parametrize(
    ("setup", "losses"),
    [
        (None, {"package": 0, "launch": 0}),
        (replace(SETUP, manifest=Message.of("there is none")), {"package": 0.5, "launch": 0}),
        (replace(SETUP, absent=("urdf/a.urdf",)), {"package": 0.5, "launch": 0}),
        (replace(SETUP, folders=("meshes/a",)), {"package": 0.5, "launch": 0}),
        (replace(SETUP, problem=NAME_ERROR), {"package": 0.5, "launch": 0}),
        (replace(SETUP, scripts_folder=""), {"package": 0.5}),
        (replace(SETUP, scripts=(replace(SCRIPT, fault=MISSING),)), {"package": 0.5}),
        (replace(SETUP, scripts=(SCRIPT, replace(SCRIPT, fault=MISSING))), {"package": 0.5}),
        (replace(SETUP, scripts=()), {"package": 0, "launch": 0.6}),
    ],
)
def test_a_package_is_judged_by_what_it_installs(setup, losses):
    assert lost(package=PackageTrace(setup, launches=(LAUNCH,), texts=(URDF,))) == losses


def lacks(kind, name, *more):
    return {"nodes": (ROBOT, OWN, *more), "lacking": (Lacking(kind, name, "", ""),)}


WITH_RVIZ = replace(node("rviz2", "rviz2"), arguments=("-d", RVIZ))


@pytest.mark.parametrize(
    ("changes", "losses"),
    [
        ({"problem": Obstacle("error", Message.of("it does not parse"))}, {"launch": 0}),
        ({"problem": Obstacle("argument", Message.of("it needs one"))}, {"launch": 0}),
        ({"nodes": (OWN,)}, {"launch": 0.6}),
        ({"nodes": (OWN,), "includes": (Include("a", "b.launch.py", ()),)}, {}),
        ({"nodes": (ROBOT,)}, {"launch": 0.6}),
        ({"nodes": (replace(ROBOT, parameters=()), OWN)}, {"launch": 0.6}),
        ({"nodes": (replace(ROBOT, parameters=(described(1),)), OWN)}, {"launch": 0.6}),
        ({"nodes": (ROBOT, replace(OWN, package="other"))}, {"launch": 0.6}),
        ({"nodes": (ROBOT, OWN, node("j", "joint_state_publisher_gui"))}, {"launch": 0.6}),
        ({"moved": "/prefix/share/walker/a.urdf"}, {"launch": 0}),
        (lacks("executable", "walker x"), {"launch": 0}),
        (lacks("file", "/home/me/a.urdf"), {"launch": 0}),
        (lacks("package", "walkr"), {"launch": 0}),
        (lacks("file", RVIZ, WITH_RVIZ), {"launch": 0.8}),
    ],
)
def test_a_launch_file_starts_robot_and_node_and_finds_what_it_reads(changes, losses):
    launch = replace(LAUNCH, **changes)
    trace = PackageTrace(SETUP, launches=(launch,), texts=(URDF, "urdf/walker.urdf"))
    assert lost(package=trace) == losses


def test_of_several_launch_files_the_best_counts():
    bad = replace(LAUNCH, problem=Obstacle("error", Message.of("it does not parse")))
    assert lost(package=PackageTrace(SETUP, launches=(bad, LAUNCH), texts=(URDF,))) == {}


def test_what_the_grader_does_not_know_is_not_judged():
    unknown = replace(LAUNCH, problem=Obstacle("unknown", Message.of("it imports launch_x")))
    trace = PackageTrace(SETUP, launches=(unknown,), texts=(URDF,))
    found = judged(WALKS, trace)
    assert [verdict.check for verdict in found if verdict.status == "not_judged"] == ["launch"]
