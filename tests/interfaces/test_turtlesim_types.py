"""The interface packages: the original's types under both of its names, and they really travel.

Where ROS is sourced this checks apt's package in the same way.
"""

import json
from pathlib import Path
from typing import Any

import pytest
from ament_index_python.packages import get_package_share_directory
from rclpy.action import ActionServer
from type_description_interfaces.srv import GetTypeDescription

from tests.graph import Graph
from turtlesim_py.ros.interfaces import NAMES, Interfaces, installed

#: By package and type. Those of turtlesim were measured on 1.8.2; later ones of Jazzy have the
#: same. Two programs talk only where these are equal. Those of turtlesim_msgs are of the same
#: definitions under their newer name, which is a part of the hash, by the same generator.
HASHES = json.loads(Path(__file__).with_name("hashes.json").read_text(encoding="utf-8"))
TYPE_HASHES = HASHES["turtlesim"]

#: What `ros2 interface show` prints of the two that have comments.
COMMENTED = {
    "action/RotateAbsolute.action": """\
# The desired heading in radians
float32 theta
---
# The angular displacement in radians to the starting position
float32 delta
---
# The remaining rotation in radians
float32 remaining
""",
    "srv/Spawn.srv": """\
float32 x
float32 y
float32 theta
string name # Optional.  A unique name will be created and returned if this is empty
---
string name
""",
}

#: A message, and requests with their responses: name of the type -> values of its fields.
MESSAGES = {
    "Pose": {"x": 1.5, "y": -2.25, "theta": 0.5, "linear_velocity": 2.0, "angular_velocity": -1.0},
    "Color": {"r": 0, "g": 128, "b": 255},
}
CALLS: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "Kill": ({"name": "Schildkröte"}, {}),
    "SetPen": ({"r": 1, "g": 2, "b": 3, "width": 4, "off": 5}, {}),
    "Spawn": ({"x": 1.0, "y": 2.0, "theta": 3.0, "name": "a"}, {"name": "b"}),
    "TeleportAbsolute": ({"x": 1.0, "theta": 0.25}, {}),
    "TeleportRelative": ({"linear": 2.0}, {}),
}


@pytest.fixture
def peer(ros):
    """A node alone; its topics are not a turtle's: a simulator may stand in the same domain."""
    peer = Graph("peer")
    yield peer
    peer.close()


@pytest.fixture(params=installed())
def interfaces(request):
    """Each of the packages that are here: beside a sourced ROS only its own."""
    return Interfaces.of(request.param)


def description(package: str, name: str) -> dict[str, Any]:
    """What the package says of a type, for programs."""
    return json.loads(Path(get_package_share_directory(package), f"{name}.json").read_text())


def type_hash(package: str, name: str) -> str:
    entries = description(package, name)["type_hashes"]
    hashes = {entry["type_name"]: entry["hash_string"] for entry in entries}
    return hashes[f"{package}/{name}"]


@pytest.mark.parametrize("name", TYPE_HASHES)
def test_type_hash_is_that_of_the_original(interfaces, name):
    expected = HASHES[interfaces.package][name]
    assert type_hash(interfaces.package, name) == f"RIHS01_{expected}"


@pytest.mark.parametrize("name", COMMENTED)
def test_definition_has_the_originals_comments(name):
    installed = Path(get_package_share_directory("turtlesim"), name).read_text()
    assert installed.splitlines() == COMMENTED[name].splitlines()


@pytest.mark.applies(len(installed()) == 2, reason="beside a sourced ROS there is one package")
@pytest.mark.parametrize("name", TYPE_HASHES)
def test_both_packages_say_the_same_of_a_type(name):
    older, newer = (description(package, name)["type_description_msg"] for package in NAMES)
    assert json.loads(json.dumps(older).replace("turtlesim/", "turtlesim_msgs/")) == newer


@pytest.mark.parametrize("name", MESSAGES)
def test_message_arrives_as_it_was_sent(peer, interfaces, name):
    kind = getattr(interfaces.msg, name)
    message = kind(**MESSAGES[name])
    topic = f"sent/{interfaces.package}/{name.lower()}"
    publisher = peer.node.create_publisher(kind, topic, 7)
    received = peer.listen(kind, topic)
    peer.until(publisher.get_subscription_count, "the subscriber")
    publisher.publish(message)
    assert peer.until(lambda: received, "the message") == [message]
    (endpoint,) = peer.node.get_publishers_info_by_topic(topic)
    expected = HASHES[interfaces.package][f"msg/{name}"]
    assert str(endpoint.topic_type_hash) == f"RIHS01_{expected}"


@pytest.mark.parametrize("name", CALLS)
def test_service_is_called_and_answers(peer, interfaces, name):
    kind = getattr(interfaces.srv, name)
    asked, answered = CALLS[name]
    response, requests = kind.Response(**answered), []

    def answer(incoming: Any, _: Any) -> Any:
        requests.append(incoming)
        return response

    service = f"sent/{interfaces.package}/{name.lower()}"
    peer.node.create_service(kind, service, answer)
    assert peer.call(kind, service, **asked) == response
    assert requests[0] == kind.Request(**asked)


def test_action_gives_feedback_and_a_result(peer, interfaces):
    kind = interfaces.action.RotateAbsolute

    def execute(goal: Any) -> Any:
        goal.publish_feedback(kind.Feedback(remaining=goal.request.theta))
        goal.succeed()
        return kind.Result(delta=-goal.request.theta)

    feedback = []
    name = f"sent/{interfaces.package}/rotate_absolute"
    ActionServer(peer.node, kind, name, execute)
    client = peer.action(kind, name)
    goal = peer.done(client.send_goal_async(kind.Goal(theta=1.5), feedback.append))
    assert peer.done(goal.get_result_async()).result == kind.Result(delta=-1.5)
    peer.until(lambda: feedback, "feedback")
    assert feedback[0].feedback == kind.Feedback(remaining=1.5)


def test_a_node_describes_the_type_to_others(peer, interfaces):
    package = interfaces.package
    peer.node.create_publisher(interfaces.msg.Pose, f"described/{package}", 7)
    asked = {"type_name": f"{package}/msg/Pose", "type_hash": type_hash(package, "msg/Pose")}
    answer = peer.call(GetTypeDescription, "/peer/get_type_description", **asked)
    assert answer.successful, answer.failure_reason
    fields = [field.name for field in answer.type_description.type_description.fields]
    assert fields == ["x", "y", "theta", "linear_velocity", "angular_velocity"]
    assert [source.type_name for source in answer.type_sources] == [f"{package}/msg/Pose"]
