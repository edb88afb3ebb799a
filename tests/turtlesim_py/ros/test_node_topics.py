"""A real node's topics: names, types, hashes, QoS, and what becomes of commands."""

from __future__ import annotations

from functools import partial
from itertools import pairwise
from typing import Any

import pytest
from geometry_msgs.msg import Twist, Vector3
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from turtlesim.msg import Color, Pose
from turtlesim.srv import Kill, Spawn

from tests.graph import DEEP, Graph
from tests.programs import Program

pytestmark = pytest.mark.usefixtures("simulator")

#: Measured on turtlesim 1.8.2.
POSE_HASH = "RIHS01_739beba26bcba6920404ba722b7b8321348512f92ea5be235c47251940dd8aa9"
COLOR_HASH = "RIHS01_74492579ec0d734707aede0e742ab76c55ac50d3ff917381e5163624cb657fe5"


def ahead(speed: float, turn: float = 0.0) -> Twist:
    return Twist(linear=Vector3(x=speed), angular=Vector3(z=turn))


def test_the_graph_shows_the_originals_topics_and_two_of_pictures(
    graph: Graph, turtle: str
) -> None:
    own = {"cmd_vel": "geometry_msgs/msg/Twist", "color_sensor": "turtlesim/msg/Color"}
    own |= {"pose": "turtlesim/msg/Pose"}
    node = graph.node

    def topics() -> dict[str, list[str]]:
        heard = node.get_subscriber_names_and_types_by_node("turtlesim", "/")
        return dict(node.get_publisher_names_and_types_by_node("turtlesim", "/") + heard)

    def there() -> bool:
        return {f"/{turtle}/{name}" for name in own} <= topics().keys()

    graph.until(there, "the turtle")
    for name, kind in own.items():
        assert topics()[f"/{turtle}/{name}"] == [kind]
    expected = {
        "/parameter_events",
        "/rosout",
        "/turtle1/cmd_vel",
        "/turtle1/color_sensor",
        "/turtle1/pose",
        "/turtlesim/image",
        "/turtlesim/image/compressed",
    }

    def visible() -> set[str]:
        return {t for t in topics() if "/_" not in t and not t.startswith(f"/{turtle}/")}

    # the last test's turtle goes as it came: one by one
    graph.until(lambda: visible() == expected, "these topics, and no others")


@pytest.mark.parametrize(("topic", "expected"), [("pose", POSE_HASH), ("color_sensor", COLOR_HASH)])
def test_publishers_have_the_originals_qos_and_type_hash(
    graph: Graph, turtle: str, topic: str, expected: str
) -> None:
    name = f"/{turtle}/{topic}"

    def infos() -> list[Any]:  # whose a publisher is becomes known after it
        found = graph.node.get_publishers_info_by_topic(name)
        return [info for info in found if info.node_name == "turtlesim"]

    (info,) = graph.until(infos, name)
    assert info.node_namespace == "/"
    assert str(info.topic_type_hash) == expected
    assert info.qos_profile.reliability == ReliabilityPolicy.RELIABLE
    assert info.qos_profile.durability == DurabilityPolicy.VOLATILE


def test_the_subscription_has_the_originals_qos(graph: Graph, turtle: str) -> None:
    name = f"/{turtle}/cmd_vel"
    (info,) = graph.until(lambda: graph.node.get_subscriptions_info_by_topic(name), name)
    assert info.qos_profile.reliability == ReliabilityPolicy.RELIABLE
    assert info.qos_profile.durability == DurabilityPolicy.VOLATILE


def test_it_listens_to_parameter_events_as_the_original_does(graph: Graph) -> None:
    def infos() -> list[Any]:
        found = graph.node.get_subscriptions_info_by_topic("/parameter_events")
        return [info for info in found if info.node_name == "turtlesim"]

    (info,) = graph.until(infos, "a subscription")
    assert info.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT


@pytest.mark.parametrize("reliability", list(ReliabilityPolicy)[1:3])
def test_pose_reaches_reliable_and_best_effort_subscribers(
    graph: Graph, turtle: str, reliability: ReliabilityPolicy
) -> None:
    poses = graph.listen(Pose, f"/{turtle}/pose", QoSProfile(depth=10, reliability=reliability))
    graph.until(lambda: poses, "a pose")
    assert (poses[0].x, poses[0].theta) == (5.5, 0.0)


def test_a_transient_local_subscriber_gets_nothing_and_the_node_warns(
    graph: Graph, simulator: Program, turtle: str
) -> None:
    topic = f"/{turtle}/pose"
    qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    nothing: list[Pose] = []
    graph.node.create_subscription(Pose, topic, nothing.append, qos)
    line = simulator.wait_for_line(f"on topic '{topic}'")
    assert line.startswith("[WARN] [")
    assert line.endswith(
        f"] [turtlesim]: New subscription discovered on topic '{topic}', requesting incompatible "
        "QoS. No messages will be sent to it. Last incompatible policy: DURABILITY_QOS_POLICY\n"
    )
    poses = graph.listen(Pose, topic)
    graph.until(lambda: len(poses) > 3, "poses for somebody else")
    assert not nothing


def test_a_best_effort_commander_is_not_heard_and_the_node_warns(
    graph: Graph, simulator: Program, turtle: str
) -> None:
    topic = f"/{turtle}/cmd_vel"
    qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    publisher = graph.node.create_publisher(Twist, topic, qos)
    simulator.wait_for_line(
        f"New publisher discovered on topic '{topic}', offering incompatible QoS. No messages "
        "will be sent to it. Last incompatible policy: RELIABILITY_QOS_POLICY"
    )
    assert publisher.get_subscription_count() == 0


def test_a_command_moves_the_turtle_and_a_pose_follows_every_tick(
    graph: Graph, turtle: str
) -> None:
    poses = graph.listen(Pose, f"/{turtle}/pose")
    graph.publisher(Twist, f"/{turtle}/cmd_vel").publish(ahead(1.0))
    graph.until(lambda: poses and poses[-1].x > 5.6, "motion")
    moving = [pose for pose in poses if pose.linear_velocity == 1.0]
    steps = [b.x - a.x for a, b in pairwise(moving)]
    assert steps == pytest.approx([0.016] * len(steps), abs=1e-6)


def test_a_burst_of_commands_is_consumed_one_a_tick(graph: Graph, turtle: str) -> None:
    poses = graph.listen(Pose, f"/{turtle}/pose")
    publisher = graph.publisher(Twist, f"/{turtle}/cmd_vel")
    burst = [0.125 * number for number in range(1, 6)]
    for speed in burst:
        publisher.publish(ahead(speed))
    graph.until(lambda: poses and poses[-1].linear_velocity == burst[-1], "the last command")
    speeds = [pose.linear_velocity for pose in poses if pose.linear_velocity]
    assert speeds[: len(burst)] == burst


def test_of_a_long_burst_the_last_seven_survive(graph: Graph, turtle: str) -> None:
    poses = graph.listen(Pose, f"/{turtle}/pose")
    publisher = graph.publisher(Twist, f"/{turtle}/cmd_vel")
    for number in range(1, 41):
        publisher.publish(ahead(0.125 * number))
    graph.until(lambda: poses and poses[-1].linear_velocity == 5.0, "the last command")
    speeds = [pose.linear_velocity / 0.125 for pose in poses if pose.linear_velocity]
    last = speeds.index(40.0)
    assert speeds[last - 6 : last + 1] == [34, 35, 36, 37, 38, 39, 40]


def test_the_color_sensor_sees_the_own_pen_while_driving(graph: Graph, turtle: str) -> None:
    colors = graph.listen(Color, f"/{turtle}/color_sensor")
    graph.until(lambda: colors, "a colour")
    graph.publisher(Twist, f"/{turtle}/cmd_vel").publish(ahead(2.0))
    graph.until(lambda: (colors[-1].r, colors[-1].g, colors[-1].b) == (179, 184, 255), "the pen")


def test_turtles_publish_in_the_bytewise_order_of_their_names(graph: Graph) -> None:
    names = ["zoe", "Zoe", "alice"]
    sent: list[tuple[int, str]] = []  # when, who
    for name in names:
        graph.call(Spawn, "/spawn", x=1.0, y=1.0, name=name)
        note = partial(lambda who, _, info: sent.append((info["source_timestamp"], who)), name)
        graph.node.create_subscription(Pose, f"/{name}/pose", note, DEEP)
    graph.until(lambda: {who for _, who in sent} == set(names), "poses of all three")
    first = max(min(when for when, who in sent if who == name) for name in names)

    def order() -> list[str]:
        """Who has sent since all three are heard: what has come of one may be behind the others."""
        return [who for when, who in sorted(sent) if when >= first]

    graph.until(lambda: min(map(order().count, names)) > 6, "more poses")
    found = order()
    start = found.index("Zoe")
    assert found[start : start + 12] == ["Zoe", "alice", "zoe"] * 4
    for name in names:
        graph.call(Kill, "/kill", name=name)
