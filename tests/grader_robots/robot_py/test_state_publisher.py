"""What a state publisher does while it runs: one for all tests, which leave it as it was."""

from typing import Any

import pytest
from rcl_interfaces.srv import ListParameters
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from tests.grader_robots.robot_py.test_nodes import (
    LATCHED,
    SECOND,
    WALKER,
    described,
    heard_by_it,
    joint_state,
    number,
    set_parameter,
    state_publisher,
    text,
)

BEST_EFFORT = QoSProfile(depth=1000, reliability=ReliabilityPolicy.BEST_EFFORT)


@pytest.fixture(scope="module")
def walking(session_graph, tmp_path_factory):
    """A state publisher of its, for tests that leave it as it was."""
    with state_publisher(*described(tmp_path_factory.mktemp("walking"), WALKER)) as program:
        session_graph.meet("robot_state_publisher")
        session_graph.forget()
        yield program
        assert program.stop() == 0


def stamps_ns(messages: list[Any]) -> list[int]:
    stamps = [message.transforms[0].header.stamp for message in messages]
    return [stamp.sec * SECOND + stamp.nanosec for stamp in stamps]


def test_description_and_fixed_frames_are_there_for_who_comes_late(graph, walking):
    walking.wait_for_line("[robot_state_publisher]: Robot initialized")
    walking.wait_for_line("[kdl_parser]: The root link axis has an inertia")
    descriptions = graph.listen(String, "/robot_description", LATCHED)
    static = graph.listen(TFMessage, "/tf_static", LATCHED)
    graph.until(lambda: descriptions and static, "what is latched")
    assert descriptions[0].data.strip() == WALKER.strip()
    frames = [(one.header.frame_id, one.child_frame_id) for one in static[0].transforms]
    assert frames == [("rod", "box"), ("axis", "leg1"), ("axis", "leg2")]
    assert static[0].transforms[1].transform.translation.y == 0.31


def test_of_two_joint_states_within_50_ms_one_goes_on_to_tf(graph, walking):
    """By their stamps: how fast the messages themselves come is all the same."""
    heard = graph.listen(TFMessage, "/tf")
    sender = heard_by_it(graph, heard)
    # in the past: what is ahead of the clock always passes
    start = graph.node.get_clock().now().nanoseconds - 10 * SECOND
    sent = [start, start + SECOND // 30, start + 2 * SECOND]
    for stamp in sent:
        sender.publish(joint_state(stamp, "tilt", "swivel"))
    graph.until(lambda: sent[-1] in stamps_ns(heard), "the last one's transforms")
    # what was sent to be heard at all may still come, and is of now
    between = [each for each in heard if stamps_ns([each])[0] <= sent[-1]]
    assert stamps_ns(between) == [sent[0], sent[2]]
    frames = [[one.child_frame_id for one in message.transforms] for message in between]
    assert frames == [["head", "body"]] * 2


def test_names_of_no_joint_make_an_empty_message(graph, walking):
    heard = graph.listen(TFMessage, "/tf")
    heard_by_it(graph, heard, "wheel", BEST_EFFORT)
    assert heard[0].transforms == []


def test_joint_states_that_do_not_fit_are_told(graph, walking):
    sender = heard_by_it(graph, graph.listen(TFMessage, "/tf"))
    sender.publish(JointState(name=["tilt", "swivel"]))
    line = walking.wait_for_line("ignored a JointState message about joint(s)")
    assert "[WARN]" in line
    assert '"tilt"(,...) whose position member was empty.' in line
    sender.publish(JointState(name=["tilt", "swivel"], position=[0.5]))
    assert "[ERROR]" in walking.wait_for_line("ignored an invalid JointState message")


def test_what_it_does_not_take_is_refused_in_the_original_s_words(graph, walking):
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
    assert walking.wait_for_line("Error:") == "Error:   No name given for the robot.\n"
    walking.wait_for_line("Failed to parse robot description using: urdf_xml_parser/URDFXMLParser")
    assert "[WARN]" in walking.wait_for_line(bad)
    successful, reason = set_parameter(graph, "frame_prefix", number(1.0))
    assert not successful
    assert "is of type {string}, setting it to {double} is not allowed" in reason


def test_it_has_the_original_s_parameters(graph, walking):
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


def test_its_publishers_and_its_subscription_have_the_original_s_quality(graph, walking):
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

    def heard():
        return {
            one.node_name: one.qos_profile.reliability
            for one in node.get_subscriptions_info_by_topic("/joint_states")
        }

    graph.until(lambda: "robot_state_publisher" in heard(), "its subscription")
    assert heard()["robot_state_publisher"] == best_effort
