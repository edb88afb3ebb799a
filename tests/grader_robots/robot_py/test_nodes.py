"""The two nodes over DDS, each test with its own: how they begin, meet, and end."""

import json
import signal
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from tests.grader_robots.robot_py import urdf_cases as cases
from tests.graph import DEEP, Graph
from tests.programs import ROOT, Program

ROBOTS = Path(__file__).parent / "robots"
WALKER = (ROBOTS / "walker.urdf").read_text()
ROVER = (ROBOTS / "rover.urdf").read_text()
LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
SECOND = 1_000_000_000


@pytest.fixture
def walker(tmp_path):
    """The arguments that describe it to a node."""
    return described(tmp_path, WALKER)


def described(folder: Path, description: str) -> list[str]:
    """A description as a launch file hands it over: in a file of parameters."""
    file = folder / "parameters.yaml"
    lines = "".join(f"        {line}\n" for line in description.splitlines())
    file.write_text(f"/**:\n  ros__parameters:\n    robot_description: |\n{lines}")
    return ["--ros-args", "--params-file", str(file)]


def state_publisher(*arguments: str) -> Program:
    return Program("grader_robots.robot_py.robot_state_publisher", *arguments)


def joint_publisher(*arguments: str) -> Program:
    return Program("grader_robots.robot_py.joint_state_publisher", *arguments)


def joint_state(stamp_ns: int, *names: str) -> JointState:
    message = JointState(name=list(names), position=[0.1] * len(names))
    message.header.stamp.sec, message.header.stamp.nanosec = divmod(stamp_ns, SECOND)
    return message


def heard_by_it(
    graph: Graph, heard: list[Any], joint: str = "periscope", qos: QoSProfile = DEEP
) -> Publisher:
    """A publisher of joint states that reach the node: one of them is among the transforms heard.

    To a best-effort subscription all is lost that was sent before it knew the publisher.
    """
    sender = graph.publisher(JointState, "/joint_states", qos)

    def send_one_more() -> bool:
        now = graph.node.get_clock().now().nanoseconds
        sender.publish(joint_state(now, joint))
        return bool(heard)

    graph.until(send_one_more, "transforms of a joint state")
    return sender


def text(value: str) -> ParameterValue:
    return ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=value)


def number(value: float) -> ParameterValue:
    return ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value)


def set_parameter(graph: Graph, name: str, value: ParameterValue) -> tuple[bool, str]:
    parameters = [Parameter(name=name, value=value)]
    service = "/robot_state_publisher/set_parameters"
    (result,) = graph.call(SetParameters, service, parameters=parameters).results
    return result.successful, result.reason


def test_another_description_at_run_time_is_published_and_so_are_its_frames(graph, walker):
    with state_publisher(*walker) as program:
        graph.meet("robot_state_publisher")
        descriptions = graph.listen(String, "/robot_description", LATCHED)
        static = graph.listen(TFMessage, "/tf_static", LATCHED)
        graph.until(lambda: descriptions and static, "what is latched")
        assert set_parameter(graph, "frame_prefix", text("new/")) == (True, "")
        assert set_parameter(graph, "robot_description", text(ROVER)) == (True, "")
        graph.until(lambda: len(descriptions) == 2 and len(static) == 2, "the new one")
        assert descriptions[1].data == ROVER
        frames = [one.child_frame_id for one in static[1].transforms]
        assert frames == ["box", "leg1", "leg2", "new/base_link", "new/caster"]
        heard = graph.listen(TFMessage, "/tf")
        heard_by_it(graph, heard, "left_finger_joint")
        fingers = [one.child_frame_id for one in heard[0].transforms]
        assert fingers == ["new/left_finger", "new/right_finger"]
        assert program.stop() == 0


#: Calls the `main` of a module with one list of arguments after the other.
CALLS = """
import importlib, json, sys
main = importlib.import_module(sys.argv[1]).main
for arguments in json.loads(sys.argv[2]):
    print("code", main(["node", *arguments]), file=sys.stderr)
"""


def refuses(module: str, refused: Sequence[tuple[Sequence[str], str]]) -> None:
    """A program ends with code 2, and a complaint, for each of these arguments."""
    asked = json.dumps([arguments for arguments, _ in refused])
    words = [sys.executable, "-c", CALLS, f"grader_robots.robot_py.{module}", asked]
    ended = subprocess.run(words, cwd=ROOT, capture_output=True, text=True, check=True)
    *said, rest = ended.stderr.split("code 2\n")
    assert (len(said), rest, "Traceback" in ended.stderr) == (len(refused), "", False)
    for text, (arguments, complaint) in zip(said, refused, strict=True):
        assert complaint in text, arguments


def test_it_does_not_start_with_what_it_cannot_use():
    file, ros = str(ROBOTS / "walker.urdf"), "--ros-args"
    refuses(
        "robot_state_publisher",
        [
            ([], "[FATAL]"),
            ([], "robot_state_publisher: robot_description parameter must not be empty"),
            (["/no/such.urdf"], "Failed to open URDF file: /no/such.urdf"),
            (
                [ros, "-p", "robot_description:=hello"],
                "Unable to initialize urdf::model from robot description",
            ),
            (
                [file, ros, "-p", "publish_frequency:=1001.0"],
                "publish_frequency must be between 0 and 1000",
            ),
            (
                [file, ros, "-p", "publish_frequency:=30"],
                "parameter publish_frequency is 30, expected a number with a decimal point",
            ),
        ],
    )


def test_a_file_is_taken_with_a_warning_where_there_is_no_parameter_and_dropped_parts_are_told(
    tmp_path,
):
    file = tmp_path / "cone.urdf"
    file.write_text(cases.shape("<cone/>"))
    with state_publisher(str(file)) as program:
        warning = program.wait_for_line("No robot_description parameter, but command-line argument")
        assert "[WARN]" in warning
        program.wait_for_line("Robot initialized")
        assert [line for line in program.lines if line.startswith("Error:")] == [
            "Error:   Unknown geometry type 'cone'\n",
            "Error:   Could not parse visual element for Link [a]\n",
        ]
        assert program.stop(signal.SIGTERM) == 0


def test_joints_are_published_as_soon_as_a_description_is_latched_and_of_a_bad_one_is_warned(
    graph, walker
):
    with joint_publisher() as program:
        program.wait_for_line("Waiting for robot_description to be published")
        with state_publisher(*walker):
            states = graph.listen(JointState, "/joint_states")
            transforms = graph.listen(TFMessage, "/tf")
            graph.until(lambda: states and transforms, "joints and their transforms")
            assert states[0].name == ["tilt", "swivel", "periscope"]
            assert list(states[0].position) == [0.0, 0.0, 0.0]
            assert states[0].header.stamp.sec > 0
            children = [one.child_frame_id for one in transforms[0].transforms]
            assert children == ["rod", "head", "body"]
            sender = graph.publisher(String, "/robot_description", LATCHED)
            sender.publish(String(data=cases.robot('<joint name="a" type="revolute"/>')))
            line = program.wait_for_line('Limits must be specified for joint "a" of type')
            assert "[WARN]" in line
            assert program.stop() == 0


def test_joints_come_from_a_file_and_a_source_moves_them(graph):
    more = ["-p", "source_list:=[moved]", "-p", "rate:=50.0", "-p", "zeros.lift:=0.25"]
    with joint_publisher(str(ROBOTS / "rover.urdf"), "--ros-args", *more) as program:
        states = graph.listen(JointState, "/joint_states")
        graph.until(lambda: states, "joint states")
        assert states[0].position[2] == 0.25
        source = graph.publisher(JointState, "/moved")
        source.publish(JointState(name=["lift", "tilt"], position=[0.125, 7.0]))
        graph.until(lambda: states[-1].position[2] == 0.125, "the source's position")
        assert program.stop() == 0


def test_joints_are_not_published_with_what_cannot_be_used():
    given = {
        "rate:=0": "parameter rate is 0, expected a number above 0",
        "rate:=fast": "parameter rate is 'fast', expected a number",
        "use_mimic_tags:=1": "is 1, expected true or false",
        "source_list:=[]": "a parameter cannot be used:",
        "zeros.a:=up": "parameter zeros.a is 'up', expected a number",
        "dependent_joints.a.factor:=2.0": "All dependent_joints must at least have a parent",
    }
    refused = [(["--ros-args", "-p", value], complaint) for value, complaint in given.items()]
    no_file = (["/no/such.urdf"], "joint_state_publisher: /no/such.urdf: [Errno 2]")
    refuses("joint_state_publisher", [no_file, *refused])


def test_a_circle_of_mimics_ends_it_with_code_1(tmp_path):
    joint = '<joint name="{}" type="continuous"><mimic joint="{}"/></joint>'
    file = tmp_path / "circle.urdf"
    file.write_text(cases.robot(joint.format("a", "b") + joint.format("b", "a")))
    with joint_publisher(str(file)) as program:
        assert program.wait() == 1
        line = program.wait_for_line("Found an infinite recursive mimic chain: ['a', 'b', 'a']")
        assert "[ERROR]" in line
