from functools import partial

import pytest
from geometry_msgs.msg import Twist, Vector3
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from turtlesim.msg import Pose
from turtlesim.srv import Kill, Spawn

from tests.graph import DEEP

pytestmark = pytest.mark.usefixtures("simulator")

#: Measured on turtlesim 1.8.2.
POSE_HASH = "RIHS01_739beba26bcba6920404ba722b7b8321348512f92ea5be235c47251940dd8aa9"
COLOR_HASH = "RIHS01_74492579ec0d734707aede0e742ab76c55ac50d3ff917381e5163624cb657fe5"


def test_the_graph_shows_the_originals_topics_and_two_of_pictures(graph, turtle):
    own = {"cmd_vel": "geometry_msgs/msg/Twist", "color_sensor": "turtlesim/msg/Color"}
    own |= {"pose": "turtlesim/msg/Pose"}
    node = graph.node

    def topics():
        heard = node.get_subscriber_names_and_types_by_node("turtlesim", "/")
        return dict(node.get_publisher_names_and_types_by_node("turtlesim", "/") + heard)

    def there():
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

    def visible():
        return {t for t in topics() if "/_" not in t and not t.startswith(f"/{turtle}/")}

    # the last test's turtle goes as it came: one by one
    graph.until(lambda: visible() == expected, "these topics, and no others")


def test_publishers_and_subscriptions_have_the_originals_qos_and_type_hashes(graph, turtle):
    def info(find, topic):
        """That of the simulator; whose it is becomes known after it."""
        (found,) = graph.until(
            lambda: [each for each in find(topic) if each.node_name == "turtlesim"], topic
        )
        return found

    publishers = graph.node.get_publishers_info_by_topic
    subscriptions = graph.node.get_subscriptions_info_by_topic
    pose, color = (info(publishers, f"/{turtle}/{topic}") for topic in ("pose", "color_sensor"))
    assert (str(pose.topic_type_hash), str(color.topic_type_hash)) == (POSE_HASH, COLOR_HASH)
    for each in (pose, color, info(subscriptions, f"/{turtle}/cmd_vel")):
        assert each.qos_profile.reliability == ReliabilityPolicy.RELIABLE
        assert each.qos_profile.durability == DurabilityPolicy.VOLATILE
    events = info(subscriptions, "/parameter_events")
    assert events.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT


def test_a_transient_local_subscriber_gets_nothing_and_the_node_warns(graph, simulator, turtle):
    topic = f"/{turtle}/pose"
    qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    nothing = []
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


def test_a_best_effort_commander_is_not_heard_and_the_node_warns(graph, simulator, turtle):
    topic = f"/{turtle}/cmd_vel"
    qos = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    publisher = graph.node.create_publisher(Twist, topic, qos)
    simulator.wait_for_line(
        f"New publisher discovered on topic '{topic}', offering incompatible QoS. No messages "
        "will be sent to it. Last incompatible policy: RELIABILITY_QOS_POLICY"
    )
    assert publisher.get_subscription_count() == 0


def test_of_a_long_burst_the_last_seven_survive(graph, turtle):
    poses = graph.listen(Pose, f"/{turtle}/pose")
    publisher = graph.publisher(Twist, f"/{turtle}/cmd_vel")
    for number in range(1, 41):
        publisher.publish(Twist(linear=Vector3(x=0.125 * number)))
    graph.until(lambda: poses and poses[-1].linear_velocity == 5.0, "the last command")
    speeds = [pose.linear_velocity / 0.125 for pose in poses if pose.linear_velocity]
    last = speeds.index(40.0)
    assert speeds[last - 6 : last + 1] == [34, 35, 36, 37, 38, 39, 40]


def test_turtles_publish_in_the_bytewise_order_of_their_names(graph):
    names = ["zoe", "Zoe", "alice"]
    sent = []  # when, who
    for name in names:
        graph.call(Spawn, "/spawn", x=1.0, y=1.0, name=name)
        note = partial(lambda who, _, info: sent.append((info["source_timestamp"], who)), name)
        graph.node.create_subscription(Pose, f"/{name}/pose", note, DEEP)
    graph.until(lambda: {who for _, who in sent} == set(names), "poses of all three")
    first = max(min(when for when, who in sent if who == name) for name in names)

    def order():
        """Who has sent since all three are heard: what has come of one may be behind the others."""
        return [who for when, who in sorted(sent) if when >= first]

    graph.until(lambda: min(map(order().count, names)) > 6, "more poses")
    found = order()
    start = found.index("Zoe")
    assert found[start : start + 12] == ["Zoe", "alice", "zoe"] * 4
    for name in names:
        graph.call(Kill, "/kill", name=name)
