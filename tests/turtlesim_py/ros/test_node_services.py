import re
from pathlib import Path

import pytest
from geometry_msgs.msg import Twist, Vector3
from PIL import Image
from rcl_interfaces.msg import Log, Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from std_srvs.srv import Empty, Trigger
from turtlesim.msg import Color, Pose
from turtlesim.srv import Kill, Spawn, TeleportAbsolute

from tests.graph import ROSOUT_QOS, wait_for_arrival
from turtlesim_py.ros.node import TurtlesimNode
from turtlesim_py.world.arena import TICK_NS

#: `Log.WARN`, a byte or a number depending on who built the message.
WARN = 30


@pytest.fixture
def emptied(graph, simulator):
    graph.call(Empty, "/reset")


def test_the_graph_shows_the_originals_services_and_one_for_pictures(graph, turtle):
    def services():
        found = graph.node.get_service_names_and_types_by_node("turtlesim", "/")
        return {name: types for name, types in found if "/_" not in name}

    own = {
        f"/{turtle}/set_pen": "turtlesim/srv/SetPen",
        f"/{turtle}/teleport_absolute": "turtlesim/srv/TeleportAbsolute",
        f"/{turtle}/teleport_relative": "turtlesim/srv/TeleportRelative",
        "/clear": "std_srvs/srv/Empty",
        "/reset": "std_srvs/srv/Empty",
        "/spawn": "turtlesim/srv/Spawn",
        "/kill": "turtlesim/srv/Kill",
        "/turtlesim/save_canvas": "std_srvs/srv/Trigger",
    }
    of_every_node = {
        "/turtlesim/describe_parameters",
        "/turtlesim/get_parameter_types",
        "/turtlesim/get_parameters",
        "/turtlesim/get_type_description",
        "/turtlesim/list_parameters",
        "/turtlesim/set_parameters",
        "/turtlesim/set_parameters_atomically",
    }
    # each becomes known by itself, in any order
    graph.until(lambda: own.keys() | of_every_node <= services().keys(), "all services")
    found = services()
    assert {name: found[name] for name in own} == {name: [kind] for name, kind in own.items()}
    of_the_node = {name for name in found if name.startswith("/turtlesim/")}
    assert of_the_node == of_every_node | {"/turtlesim/save_canvas"}


def test_of_many_requests_of_one_service_the_last_ten_are_kept(graph):
    node = TurtlesimNode(["--ros-args", "-r", "__ns:=/crowded"])
    name = "/crowded/spawn"
    for number in range(15):
        graph.ask(Spawn, name, name=f"number{number}")
    graph.ask(Empty, "/crowded/clear")  # sent last, it arrives last
    (last,) = (each for each in node.services if each.service_name == "/crowded/clear")
    wait_for_arrival(last)
    for tick in range(1, 21):
        node.tick(tick * TICK_NS)
    assert list(node.arena.turtles) == ["turtle1", *(f"number{n}" for n in range(5, 15))]
    node.destroy_node()


def test_a_spawned_turtle_is_logged_and_lives_until_it_is_killed(graph, simulator):
    begin = len(simulator.lines)
    assert graph.call(Spawn, "/spawn", x=1.5, y=2.5, theta=0.5, name="eve").name == "eve"
    line = simulator.wait_for_line("[eve]", begin)
    assert line.startswith("[INFO] [")
    assert "]: Spawning turtle [eve] at x=[1.500000], y=[2.500000], theta=[0.500000]" in line
    poses = graph.listen(Pose, "/eve/pose")
    graph.until(lambda: poses, "a pose")
    assert (poses[0].x, poses[0].y, poses[0].theta) == (1.5, 2.5, 0.5)
    graph.call(Kill, "/kill", name="eve")
    count, services = graph.node.count_publishers, graph.node.get_service_names_and_types
    graph.until(lambda: count("/eve/pose") == count("/eve/color_sensor") == 0, "its end")
    graph.until(lambda: "/eve" not in str(services()), "its services' end")


@pytest.mark.usefixtures("emptied")
def test_a_turtle_without_a_name_gets_the_next_free_number(graph):
    assert graph.call(Spawn, "/spawn", x=1.0, y=1.0).name == "turtle2"
    graph.call(Kill, "/kill", name="turtle1")
    assert graph.call(Spawn, "/spawn", x=1.0, y=1.0).name == "turtle3"
    graph.call(Empty, "/reset")


def test_a_name_that_is_taken_and_one_that_nobody_has_are_errors_in_the_log(graph, simulator):
    assert graph.call(Spawn, "/spawn", x=1.0, y=1.0, name="turtle1").name == ""
    line = simulator.wait_for_line("A turtle named [turtle1] already exists")
    assert line.startswith("[ERROR]")
    assert graph.call(Kill, "/kill", name="nobody") == Kill.Response()
    line = simulator.wait_for_line("Tried to kill turtle [nobody], which does not exist")
    assert line.startswith("[ERROR]")


@pytest.mark.parametrize(
    "name", ["bad name", "1abc", "é", "~x", "/", "{nothing}", "n" * 250, "a\nb"]
)
def test_an_invalid_name_is_an_error_and_the_node_lives_on(graph, simulator, name):
    begin = len(simulator.lines)
    assert graph.call(Spawn, "/spawn", x=1.0, y=1.0, name=name).name == ""
    line = simulator.wait_for_line("Cannot spawn a turtle named [", begin)
    assert line.startswith("[ERROR]")
    assert simulator.process.poll() is None


@pytest.mark.parametrize(
    ("name", "prefix"),
    [
        ("a/b", "/a/b"),
        ("/abs", "/abs"),
        ("~/x", "/turtlesim/x"),
        ("{node}", "/turtlesim"),
        ("a__B", "/a__B"),
    ],
)
@pytest.mark.usefixtures("simulator")
def test_every_name_that_topics_can_have_is_good(graph, name, prefix):
    assert graph.call(Spawn, "/spawn", x=1.0, y=1.0, name=name).name == name
    poses = graph.listen(Pose, f"{prefix}/pose")
    graph.until(lambda: poses, "a pose")
    graph.call(Kill, "/kill", name=name)


@pytest.mark.usefixtures("emptied")
def test_reset_leaves_one_turtle_in_the_centre_and_an_empty_canvas(graph, simulator):
    graph.call(Spawn, "/spawn", x=1.0, y=1.0, name="other")
    graph.call(TeleportAbsolute, "/turtle1/teleport_absolute", x=1.0, y=1.0)
    begin = len(simulator.lines)
    graph.call(Empty, "/reset")
    simulator.wait_for_line("Resetting turtlesim.", begin)
    simulator.wait_for_line("Spawning turtle [turtle1] at x=[5.544445], y=[5.544445]", begin)
    graph.until(lambda: graph.node.count_publishers("/other/pose") == 0, "the end of the other")
    poses = graph.listen(Pose, "/turtle1/pose")
    graph.until(lambda: poses, "a pose")
    assert poses[-1].x == poses[-1].y == 5.544444561004639


def test_clear_wipes_what_was_drawn(graph, simulator, turtle):
    colors = graph.listen(Color, f"/{turtle}/color_sensor")
    graph.call(TeleportAbsolute, f"/{turtle}/teleport_absolute", x=7.0, y=5.5)
    graph.until(lambda: colors and colors[-1].g == 184, "paint")
    begin = len(simulator.lines)
    graph.call(Empty, "/clear")
    assert simulator.wait_for_line("Clearing turtlesim.", begin).startswith("[INFO]")
    graph.until(lambda: colors[-1].g == 255, "none")


def test_hitting_the_wall_warns_in_every_tick_and_on_rosout(graph, simulator, turtle):
    logs = graph.listen(Log, "/rosout", ROSOUT_QOS)
    graph.call(TeleportAbsolute, f"/{turtle}/teleport_absolute", x=11.0, y=5.5)
    begin = len(simulator.lines)
    command = Twist(linear=Vector3(x=2.0))
    graph.publisher(Twist, f"/{turtle}/cmd_vel").publish(command)
    text = "Oh no! I hit the wall! (Clamping from [x="

    def warnings():
        return [log for log in logs if text in log.msg]

    graph.until(lambda: len(warnings()) >= 10, "ten warnings on /rosout")
    assert {(log.level, log.name) for log in warnings()} == {(WARN, "turtlesim")}
    assert simulator.wait_for_line(text, begin).startswith("[WARN]")


def test_save_canvas_writes_numbered_pictures_and_through_no_link(graph, simulator, tmp_path):
    def saved():
        answer = graph.call(Trigger, "/turtlesim/save_canvas")
        assert answer.success
        return Path(answer.message)

    paths = [saved(), saved()]
    assert all(re.fullmatch(r"canvas_\d{3}\.png", path.name) for path in paths)
    assert paths[0].name < paths[1].name
    with Image.open(paths[0]) as image:
        assert (image.size, image.mode) == ((500, 500), "RGB")
        assert image.getpixel((0, 0)) == (69, 86, 255)
    paths[1].unlink()
    paths[1].symlink_to(tmp_path / "elsewhere.png")
    assert saved().name > paths[1].name
    assert not (tmp_path / "elsewhere.png").exists()
    paths[1].unlink()


@pytest.mark.parametrize("folder", ["~nosuchuser/x", "/dev/null", "/proc/nothing", "x" * 5000])
def test_save_canvas_says_where_it_cannot_write(graph, simulator, folder):
    def choose(name):
        value = ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=name)
        parameters = [Parameter(name="canvas_folder", value=value)]
        answer = graph.call(SetParameters, "/turtlesim/set_parameters", parameters=parameters)
        assert answer.results[0].successful

    choose(folder)
    answer = graph.call(Trigger, "/turtlesim/save_canvas")
    choose(".")
    assert not answer.success
    assert answer.message.startswith("cannot write the canvas to ")
