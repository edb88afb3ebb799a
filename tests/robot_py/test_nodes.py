"""The two nodes over DDS: what is latched, what goes to /tf, what is refused, how they end."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import Any

import pytest
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import ListParameters, SetParameters
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from tests.graph import DEEP, Graph
from tests.programs import Program
from tests.robot_py import urdf_cases as cases

ROBOTS = Path(__file__).parent / "robots"
WALKER = (ROBOTS / "walker.urdf").read_text()
ROVER = (ROBOTS / "rover.urdf").read_text()
LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
BEST_EFFORT = QoSProfile(depth=1000, reliability=ReliabilityPolicy.BEST_EFFORT)
SECOND = 1_000_000_000


@pytest.fixture
def walker(tmp_path) -> list[str]:
    """The arguments that describe it to a node."""
    return described(tmp_path, WALKER)


def described(folder: Path, description: str) -> list[str]:
    """A description as a launch file hands it over: in a file of parameters."""
    file = folder / "parameters.yaml"
    lines = "".join(f"        {line}\n" for line in description.splitlines())
    file.write_text(f"/**:\n  ros__parameters:\n    robot_description: |\n{lines}")
    return ["--ros-args", "--params-file", str(file)]


def state_publisher(*arguments: str) -> Program:
    return Program("robot_py.ros.robot_state_publisher", *arguments)


def joint_publisher(*arguments: str) -> Program:
    return Program("robot_py.ros.joint_state_publisher", *arguments)


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


def stamps_ns(messages: list[Any]) -> list[int]:
    stamps = [message.transforms[0].header.stamp for message in messages]
    return [stamp.sec * SECOND + stamp.nanosec for stamp in stamps]


def text(value: str) -> ParameterValue:
    return ParameterValue(type=ParameterType.PARAMETER_STRING, string_value=value)


def number(value: float) -> ParameterValue:
    return ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=value)


def set_parameter(graph: Graph, name: str, value: ParameterValue) -> tuple[bool, str]:
    parameters = [Parameter(name=name, value=value)]
    service = "/robot_state_publisher/set_parameters"
    (result,) = graph.call(SetParameters, service, parameters=parameters).results
    return result.successful, result.reason


def test_description_and_fixed_frames_are_there_for_who_comes_late(graph, walker):
    with state_publisher(*walker) as program:
        program.wait_for_line("[robot_state_publisher]: Robot initialized")
        program.wait_for_line("[kdl_parser]: The root link axis has an inertia")
        descriptions = graph.listen(String, "/robot_description", LATCHED)
        static = graph.listen(TFMessage, "/tf_static", LATCHED)
        graph.until(lambda: descriptions and static, "what is latched")
        assert descriptions[0].data.strip() == WALKER.strip()
        frames = [(one.header.frame_id, one.child_frame_id) for one in static[0].transforms]
        assert frames == [("rod", "box"), ("axis", "leg1"), ("axis", "leg2")]
        assert static[0].transforms[1].transform.translation.y == 0.31
        assert program.stop() == 0


def test_of_30_joint_states_a_second_15_go_on_to_tf(graph, walker):
    """By their stamps: how fast the messages themselves come is all the same."""
    with state_publisher(*walker):
        heard = graph.listen(TFMessage, "/tf")
        sender = heard_by_it(graph, heard)
        begun = len(heard)
        # in the past: what is ahead of the clock always passes
        start = graph.node.get_clock().now().nanoseconds - 10 * SECOND
        sent = [start + number * SECOND // 30 for number in range(60)]
        for stamp in sent:
            sender.publish(joint_state(stamp, "tilt", "swivel"))
            if stamp in sent[::2]:  # every other one comes through: none waits for the next
                graph.until(lambda s=stamp: s in stamps_ns(heard), "its transforms")
        # a last one, which passes whatever was before: so all before it has been looked at
        sender.publish(joint_state(sent[-1] + SECOND, "tilt"))
        graph.until(lambda: stamps_ns(heard[-1:]) == [sent[-1] + SECOND], "the last one")
        between = heard[begun:-1]
        assert stamps_ns(between) == sent[::2]
        frames = [[one.child_frame_id for one in message.transforms] for message in between]
        assert frames == [["head", "body"]] * 30


def test_names_of_no_joint_make_an_empty_message(graph, walker):
    with state_publisher(*walker):
        heard = graph.listen(TFMessage, "/tf")
        heard_by_it(graph, heard, "wheel", BEST_EFFORT)
        assert heard[0].transforms == []


def test_joint_states_that_do_not_fit_are_told(graph, walker):
    with state_publisher(*walker) as program:
        sender = heard_by_it(graph, graph.listen(TFMessage, "/tf"))
        sender.publish(JointState(name=["tilt", "swivel"]))
        line = program.wait_for_line("ignored a JointState message about joint(s)")
        assert "[WARN]" in line
        assert '"tilt"(,...) whose position member was empty.' in line
        sender.publish(JointState(name=["tilt", "swivel"], position=[0.5]))
        assert "[ERROR]" in program.wait_for_line("ignored an invalid JointState message")


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


def test_what_it_does_not_take_is_refused_in_the_original_s_words(graph, walker):
    with state_publisher(*walker) as program:
        graph.meet("robot_state_publisher")
        refused = [
            set_parameter(graph, "robot_description", text("")),
            set_parameter(graph, "robot_description", text("<robot/>")),
            set_parameter(graph, "publish_frequency", number(1000.5)),
            set_parameter(graph, "publish_frequency", number(-1.0)),
        ]
        bad = "Unable to initialize urdf::model from robot description"
        frequency = "publish_frequency must be between 0.0 and 1000.0"
        reasons = ["Empty URDF is not allowed", bad, frequency, frequency]
        assert refused == [(False, reason) for reason in reasons]
        assert program.wait_for_line("Error:") == "Error:   No name given for the robot.\n"
        program.wait_for_line(
            "Failed to parse robot description using: urdf_xml_parser/URDFXMLParser"
        )
        assert "[WARN]" in program.wait_for_line(bad)
        successful, reason = set_parameter(graph, "frame_prefix", number(1.0))
        assert not successful
        assert "is of type {string}, setting it to {double} is not allowed" in reason


def test_it_has_the_original_s_parameters(graph, walker):
    with state_publisher(*walker):
        graph.meet("robot_state_publisher")
        names = graph.call(ListParameters, "/robot_state_publisher/list_parameters").result.names
        own = [
            "frame_prefix",
            "ignore_timestamp",
            "publish_frequency",
            "robot_description",
            "start_type_description_service",
            "use_sim_time",
        ]
        quality = {
            "/joint_states.subscription": ("depth", "history", "reliability"),
            "/tf.publisher": ("depth", "durability", "history", "reliability"),
            "/tf_static.publisher": ("depth", "history", "reliability"),
        }
        overrides = [
            f"qos_overrides.{where}.{policy}" for where in quality for policy in quality[where]
        ]
        assert sorted(names) == sorted([*own, *overrides])


def test_its_publishers_and_its_subscription_have_the_original_s_quality(graph, walker):
    with state_publisher(*walker):
        graph.meet("robot_state_publisher")
        node = graph.node
        names = ("/tf", "/tf_static", "/robot_description")
        graph.until(lambda: all(map(node.count_publishers, names)), "publishers")
        reliable, best_effort = ReliabilityPolicy.RELIABLE, ReliabilityPolicy.BEST_EFFORT
        volatile, latched = DurabilityPolicy.VOLATILE, DurabilityPolicy.TRANSIENT_LOCAL
        quality = {name: node.get_publishers_info_by_topic(name)[0].qos_profile for name in names}
        found = {name: (one.reliability, one.durability) for name, one in quality.items()}
        assert found == {
            "/tf": (reliable, volatile),
            "/tf_static": (reliable, latched),
            "/robot_description": (reliable, latched),
        }
        assert HistoryPolicy.KEEP_ALL not in {one.history for one in quality.values()}
        heard = {
            one.node_name: one.qos_profile.reliability
            for one in node.get_subscriptions_info_by_topic("/joint_states")
        }
        assert heard["robot_state_publisher"] == best_effort


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        ([], "[FATAL]"),
        ([], "robot_state_publisher: robot_description parameter must not be empty"),
        (["/no/such.urdf"], "Failed to open URDF file: /no/such.urdf"),
        (
            ["--ros-args", "-p", "robot_description:=hello"],
            "Unable to initialize urdf::model from robot description",
        ),
        (
            [str(ROBOTS / "walker.urdf"), "--ros-args", "-p", "publish_frequency:=1001.0"],
            "publish_frequency must be between 0 and 1000",
        ),
        (
            [str(ROBOTS / "walker.urdf"), "--ros-args", "-p", "publish_frequency:=30"],
            "parameter publish_frequency is 30, expected a number with a decimal point",
        ),
    ],
)
def test_it_does_not_start_with_what_it_cannot_use(arguments, complaint):
    with state_publisher(*arguments) as program:
        assert program.wait() == 2
        assert complaint in program.text()
        assert "Traceback" not in program.text()


def test_a_file_is_taken_with_a_warning_where_there_is_no_parameter():
    with state_publisher(str(ROBOTS / "rover.urdf")) as program:
        warning = program.wait_for_line("No robot_description parameter, but command-line argument")
        assert "[WARN]" in warning
        program.wait_for_line("Robot initialized")
        assert program.stop(signal.SIGTERM) == 0


def test_dropped_parts_are_told_on_the_terminal(tmp_path):
    with state_publisher(*described(tmp_path, cases.shape("<cone/>"))) as program:
        program.wait_for_line("Robot initialized")
        assert program.lines[:2] == [
            "Error:   Unknown geometry type 'cone'\n",
            "Error:   Could not parse visual element for Link [a]\n",
        ]


def test_joints_are_published_as_soon_as_a_description_is_latched(graph, walker):
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
            assert program.stop() == 0


def test_joints_come_from_a_file_and_a_source_moves_them(graph):
    more = ["-p", "source_list:=[moved]", "-p", "rate:=50", "-p", "zeros.lift:=0.25"]
    with joint_publisher(str(ROBOTS / "rover.urdf"), "--ros-args", *more) as program:
        states = graph.listen(JointState, "/joint_states")
        graph.until(lambda: states, "joint states")
        assert states[0].position[2] == 0.25
        source = graph.publisher(JointState, "/moved")
        source.publish(JointState(name=["lift", "tilt"], position=[0.125, 7.0]))
        graph.until(lambda: states[-1].position[2] == 0.125, "the source's position")
        assert program.stop() == 0


def test_a_description_that_joints_cannot_be_read_from_is_warned_of(graph):
    with joint_publisher() as program:
        sender = graph.publisher(String, "/robot_description", LATCHED)
        sender.publish(String(data=cases.robot('<joint name="a" type="revolute"/>')))
        line = program.wait_for_line('Limits must be specified for joint "a" of type "revolute"')
        assert "[WARN]" in line
        assert program.stop() == 0


@pytest.mark.parametrize(
    ("arguments", "code", "complaint"),
    [
        (["/no/such.urdf"], 2, "joint_state_publisher: /no/such.urdf: [Errno 2]"),
        (["--ros-args", "-p", "rate:=0"], 2, "parameter rate is 0, expected a number above 0"),
        (
            ["--ros-args", "-p", "dependent_joints.a.factor:=2.0"],
            2,
            "All dependent_joints must at least have a parent",
        ),
    ],
)
def test_joints_are_not_published_with_what_cannot_be_used(arguments, code, complaint):
    with joint_publisher(*arguments) as program:
        assert program.wait() == code
        assert complaint in program.text()
        assert "Traceback" not in program.text()


def test_a_circle_of_mimics_ends_it_with_code_1(tmp_path):
    limit = '<limit lower="-1" upper="1"/>'
    circle = cases.robot(
        f'<joint name="a" type="revolute">{limit}<mimic joint="b"/></joint>'
        f'<joint name="b" type="revolute">{limit}<mimic joint="a"/></joint>'
    )
    file = tmp_path / "circle.urdf"
    file.write_text(circle)
    with joint_publisher(str(file)) as program:
        assert program.wait() == 1
        line = program.wait_for_line("Found an infinite recursive mimic chain: ['a', 'b', 'a']")
        assert "[ERROR]" in line
