import re

import pytest
from rcl_interfaces.srv import GetParameters

from tests.programs import Program
from tests.tiers import others_are_more
from turtlesim_py.ros import interfaces
from turtlesim_py.ros.interfaces import NAMES, Interfaces, installed, of_release, usual
from turtlesim_py.ros.node import TurtlesimNode
from turtlesim_py.ros.rclcpp_node import UnusableParameter

both = pytest.mark.applies(
    len(installed()) == 2, reason="beside a sourced ROS there is one package"
)


@pytest.mark.parametrize(
    ("release", "package"),
    [
        *((release, "turtlesim") for release in ("", "foxy", "humble", "jazzy")),
        *((release, "turtlesim_msgs") for release in ("kilted", "lyrical", "rolling")),
    ],
)
def test_each_release_has_its_own(monkeypatch, release, package):
    monkeypatch.setattr(interfaces, "installed", lambda: NAMES)
    monkeypatch.setenv("ROS_DISTRO", release)
    assert of_release(release) == usual() == package


def test_without_a_sourced_ros_the_older_is_usual_and_so_where_the_newer_is_missing(monkeypatch):
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    assert usual() == "turtlesim"
    monkeypatch.setenv("ROS_DISTRO", "kilted")
    monkeypatch.setattr(interfaces, "installed", lambda: ("turtlesim",))
    assert usual() == "turtlesim"


def test_a_folder_of_that_name_is_no_package(monkeypatch, tmp_path):
    (tmp_path / "turtle_messages").mkdir()
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(interfaces, "NAMES", ("turtle_messages", "nowhere", "json"))
    assert installed() == ("json",)


@both
def test_the_classes_are_those_of_the_package():
    for name in NAMES:
        made = Interfaces.of(name)
        assert made.package == name
        assert made.msg.Pose.__module__.startswith(f"{name}.msg.")
        assert made.srv.Spawn.__module__.startswith(f"{name}.srv.")
        assert made.action.RotateAbsolute.__module__.startswith(f"{name}.action.")


@both
@pytest.mark.parametrize(
    "package", others_are_more("all other tests of nodes are of it", NAMES, "turtlesim_msgs")
)
def test_a_node_serves_the_one_that_it_is_told_to_and_only_that(graph, package):
    namespace = f"/of_{package}"
    arguments = ["-r", f"__ns:={namespace}", "-p", f"interfaces:={package}"]
    kinds = Interfaces.of(package)
    with Program("turtlesim_py.ros.node", "--ros-args", *arguments) as program:
        graph.meet(f"of_{package}.turtlesim")
        poses = graph.listen(kinds.msg.Pose, f"{namespace}/turtle1/pose")
        colors = graph.listen(kinds.msg.Color, f"{namespace}/turtle1/color_sensor")
        graph.until(lambda: poses and colors, "readings")
        assert (poses[0].x, poses[0].y) == (5.544444561004639,) * 2
        assert (colors[0].r, colors[0].g, colors[0].b) == (255, 255, 255)
        graph.call(kinds.srv.SetPen, f"{namespace}/turtle1/set_pen", r=1, width=3)
        graph.call(
            kinds.srv.TeleportAbsolute, f"{namespace}/turtle1/teleport_absolute", x=2.0, y=3.0
        )
        graph.call(kinds.srv.TeleportRelative, f"{namespace}/turtle1/teleport_relative", linear=1.0)
        graph.until(lambda: poses[-1].x == 3.0, "the teleported")
        assert graph.call(kinds.srv.Spawn, f"{namespace}/spawn", x=1.0, name="late").name == "late"
        rotation = graph.action(kinds.action.RotateAbsolute, f"{namespace}/late/rotate_absolute")
        goal = graph.done(rotation.send_goal_async(kinds.action.RotateAbsolute.Goal(theta=0.1)))
        assert graph.done(goal.get_result_async()).result.delta == pytest.approx(-0.096)
        graph.call(kinds.srv.Kill, f"{namespace}/kill", name="late")
        node = graph.node
        named = (*node.get_topic_names_and_types(), *node.get_service_names_and_types())
        types = [type_ for name, types in named if name.startswith(namespace) for type_ in types]
        assert {name.partition("/")[0] for name in types} & set(NAMES) == {package}
        values = graph.call(
            GetParameters, f"{namespace}/turtlesim/get_parameters", names=["interfaces"]
        ).values
        assert [value.string_value for value in values] == [package]
        assert program.stop() == 0


@pytest.mark.usefixtures("ros")
@pytest.mark.parametrize(
    ("there", "override", "complaint"),
    [
        (NAMES, "std_msgs", "interfaces is 'std_msgs', expected one of turtlesim, turtlesim_msgs"),
        (("turtlesim",), "turtlesim_msgs", "expected an installed package, and here is turtlesim"),
        ((), "turtlesim", "expected an installed package, and here is neither of them"),
    ],
)
def test_what_is_not_there_is_named(monkeypatch, there, override, complaint):
    monkeypatch.setattr(interfaces, "installed", lambda: there)
    with pytest.raises(UnusableParameter, match=re.escape(complaint)):
        TurtlesimNode(["--ros-args", "-r", "__ns:=/unusable", "-p", f"interfaces:={override}"])
