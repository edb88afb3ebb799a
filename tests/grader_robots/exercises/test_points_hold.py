"""Less never earns more, and one more file never costs points: for each exercise about robots."""

from __future__ import annotations

import math
import shutil
import tempfile
from collections.abc import Mapping
from functools import cache
from itertools import combinations
from pathlib import Path

import pytest

from grader.exercise.loading import load_exercise
from grader.judging import judge
from grader.recording.recording import Recording, Recordings
from grader_robots.scene.driving import drive, joint_state, tf
from robot_py.robot_state import Placed
from tests.grader_robots.packages import looked_at, recorded
from tests.tiers import others_are_more

#: A passage of a file, and what stands there instead; a passage '' is the whole file.
Change = tuple[str, str, str]
NO_FILE = ""
XACRO, SPAWN = "urdf/walker.urdf.xacro", "launch/spawn.launch.py"
DISPLAY = "launch/display.launch.py"
SHARE = '        ("share/" + package_name + "/{0}", glob("{0}/*")),\n'
THYMIO, SHOW = "urdf/thymio.urdf.xacro", "launch/display.launch.xml"
CASTER = '<link name="caster_wheel_link">', '<xacro:if value="0"><link name="caster_wheel_link">'
WALKER, LAUNCH = "urdf/walker.urdf", "launch/walker.launch.py"
#: Exercise -> what is taken away from its reference, or broken.
TAKEN: Mapping[str, Mapping[str, tuple[Change, ...]]] = {
    "description_package": {
        "a leg": ((XACRO, '<xacro:leg side="right" sign="-1"/>', ""),),
        "a joint": ((XACRO, '<xacro:leg side="left" sign="1"/>', '<link name="left"/>'),),
        "the end of the URDF": ((XACRO, "</robot>", ""),),
        "the length of a leg": ((XACRO, '<xacro:property name="leg_length" value="0.3"/>', ""),),
        "urdf in data_files": (("setup.py", SHARE.format("urdf"), ""),),
        "rviz in data_files": (("setup.py", SHARE.format("rviz"), ""),),
        "meshes in data_files": (("setup.py", SHARE.format("meshes"), ""),),
        "launch in data_files": (("setup.py", 'glob("launch/*.py")', "[]"),),
        "setup()": (("setup.py", "setup(\n", "set_up(\n"),),
        "the file for display": ((DISPLAY, "", NO_FILE),),
        "the program's name": ((DISPLAY, 'executable="rviz2"', 'executable="rviz"'),),
        "the description": ((DISPLAY, '"robot_description": description', '"a": description'),),
        "RViz's file": ((DISPLAY, ', arguments=["-d", settings]', ""),),
        "xacro": ((DISPLAY, 'Command(["xacro ", model])', "model"),),
        "a dependency": (("package.xml", "  <exec_depend>xacro</exec_depend>\n", ""),),
        "the mesh": (("meshes/camera.stl", "", NO_FILE),),
    },
    "thymio_package": {
        "a wheel": ((THYMIO, '<xacro:wheel name="right" side="-1"/>', ""),),
        "the other wheel": ((THYMIO, '<xacro:wheel name="left" side="1"/>', ""),),
        "the caster": ((THYMIO, *CASTER), (THYMIO, "</robot>", "</xacro:if></robot>")),
        "turning": ((THYMIO, 'type="continuous"', 'type="fixed"'),),
        "a property": ((THYMIO, '<box size="${base_length}', '<box size="0.11'),),
        "a mass": ((THYMIO, 'name="mass" value="0.27"', 'name="mass" value="0"'),),
        "the end of the URDF": (
            (THYMIO, '<link name="base_link">', '<link name="a"/><link name="base_link">'),
        ),
        "urdf installed": (("CMakeLists.txt", " urdf ", " "),),
        "rviz installed": (("CMakeLists.txt", " rviz ", " "),),
        "launch installed": (("CMakeLists.txt", "launch ", ""),),
        "the file for display": ((SHOW, "", NO_FILE),),
        "the file for Gazebo": ((SPAWN, "", NO_FILE),),
        "the program's name": ((SHOW, 'exec="rviz2"', 'exec="rviz"'),),
        "Gazebo's origin": ((SPAWN, '"-topic", "/robot_description", ', ""),),
        "a dependency": (("package.xml", "  <exec_depend>ros_gz</exec_depend>\n", ""),),
    },
    "state_publisher": {
        "the end of the URDF": ((WALKER, "</robot>", ""),),
        "urdf in data_files": (("setup.py", "urdf/*.urdf", "urdf/*.xacro"),),
        "launch in data_files": (("setup.py", "launch/*.launch.py", "launch/*.xml"),),
        "setup()": (("setup.py", "setup(\n", "set_up(\n"),),
        "the console script": (("setup.py", "state_publisher = walker.state_publisher:main", ""),),
        "the launch file": ((LAUNCH, "", NO_FILE),),
        "the program's name": ((LAUNCH, 'executable="state_publisher"', 'executable="walk"'),),
        "the description": ((LAUNCH, '[{"robot_description": description}]', "[]"),),
        "the swivel": (),
        "the tilt": (),
        "the odometry": (),
        "stamps": (),
    },
}
#: What mends itself where something else is taken away too: what asked for it.
MENDS = {
    frozenset(("meshes in data_files", "the mesh")),
    frozenset(("the file for Gazebo", "Gazebo's origin")),
    frozenset(("rviz in data_files", "RViz's file")),
    frozenset(("xacro", "the description")),  # the other launch file hands on a robot
    frozenset(("xacro", "the file for display")),
}
EXTRA_LAUNCH = """
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    text = "<robot name='other'><link name='a'/></robot>"
    return LaunchDescription([
        Node(package="robot_state_publisher", executable="robot_state_publisher",
             parameters=[{"robot_description": text}]),
        Node(package="rviz2", executable="rviz2"),
    ])
"""
#: One more file, which nothing uses.
EXTRA = {
    "README.md": "# A robot\n",
    "urdf/another.urdf": "<robot name='another'><link name='a'/></robot>",
    "urdf/broken.urdf": "<robot name='broken'><link name='a'>",
    "test/test_flake8.py": "def test_flake8():\n    assert True\n",
    "rviz/another.rviz": "Panels: []\n",
    "launch/another.launch.py": EXTRA_LAUNCH,
    "launch/of_ros_1.launch": "<launch><param name='a' value='b'/></launch>",
}


def walker(without):
    """What the node publishes, without what is taken away."""

    def controller(tick, now_ns):
        if tick % 2:
            return ()
        t = tick * 0.016
        moved = {"swivel": 0.5 * t, "tilt": 0.3 * math.sin(t), "periscope": 0.1 * math.sin(t)}
        moved = {name: at for name, at in moved.items() if f"the {name}" not in without}
        half = (0.5 * t + math.pi / 2) / 2
        at, turned = (2 * math.cos(t / 2), 2 * math.sin(t / 2), 0.7), (0.0, 0.0)
        stamp = 0 if "stamps" in without else now_ns
        sent = joint_state(stamp, list(moved), list(moved.values()))
        way = tf(Placed(stamp, "odom", "axis", at, (*turned, math.sin(half), math.cos(half))))
        return (sent,) if "the odometry" in without else (sent, way)

    return controller


@cache
def points(name: str, taken: frozenset[str], extra: str = "") -> float:
    """What the reference earns without these things."""
    exercise = load_exercise(name)
    with tempfile.TemporaryDirectory() as folder:
        package = Path(folder) / "package"
        shutil.copytree(exercise.folder / "reference", package)
        if extra:
            (package / extra).parent.mkdir(exist_ok=True)
            (package / extra).write_text(EXTRA[extra])
        for what in taken:
            for file, old, new in TAKEN[name][what]:
                path = package / file
                if not old:
                    path.unlink()
                elif path.exists():
                    text = path.read_text()
                    assert old in text, (what, file)
                    path.write_text(text.replace(old, new))
        trace = looked_at(package)
    recordings = recorded(trace)
    if name == "state_publisher":
        ran = drive(walker(taken), 1000, exercise.setting)
        recordings = Recordings(Recording(ran, scene="robot", package=trace))
    return judge(recordings, exercise).score


@pytest.mark.parametrize(
    "case",
    others_are_more(
        "half a second each",
        [((name, what),) for name, taken in TAKEN.items() for what in taken],
        ("description_package", "the end of the URDF"),
        ("thymio_package", "a wheel"),
        ("state_publisher", "the program's name"),
    ),
)
def test_what_is_taken_away_earns_no_points(case):
    name, what = case
    assert points(name, frozenset((what,))) <= points(name, frozenset()) == 100


@pytest.mark.more("a minute for each exercise")
@pytest.mark.parametrize("name", TAKEN)
def test_taking_away_one_thing_more_earns_no_points(name):
    gains = []
    for pair in map(frozenset, combinations(TAKEN[name], 2)):
        less = points(name, pair)
        for what in pair:
            if pair not in MENDS and less > points(name, frozenset((what,))):
                gains.append((what, *(pair - {what}), points(name, frozenset((what,))), less))
    assert gains == []


@pytest.mark.parametrize(
    "case",
    others_are_more(
        "half a second each",
        [((name, extra),) for name in TAKEN for extra in EXTRA],
        ("description_package", "launch/another.launch.py"),
    ),
)
def test_one_more_file_costs_nothing(case):
    name, extra = case
    assert points(name, frozenset(), extra) == 100
