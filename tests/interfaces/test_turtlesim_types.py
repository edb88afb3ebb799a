"""The interface packages: the original's types under both of its names, and they really travel.

Where ROS is sourced this checks apt's package in the same way.
"""

import json
from pathlib import Path
from typing import Any

import pytest
import rclpy
from ament_index_python.packages import get_package_share_directory
from rclpy.action import ActionClient, ActionServer
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future
from type_description_interfaces.srv import GetTypeDescription

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

DEADLINE_S = 30.0  # only a failing test waits for it


class Peer:
    """A node and what spins it, alone in a context of its own.

    Its topics are not a turtle's: a simulator may stand in the same domain.
    """

    def __init__(self) -> None:
        self._context = Context()
        rclpy.init(context=self._context)
        self.node = Node("peer", context=self._context)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)

    def wait_for(self, future: Future) -> Any:
        """Spin until `future` is done, and return its result."""
        self._executor.spin_until_future_complete(future, timeout_sec=DEADLINE_S)
        assert future.done(), f"nothing came within {DEADLINE_S} s"
        return future.result()

    def close(self) -> None:
        """Take everything down again."""
        self._executor.shutdown()
        self.node.destroy_node()
        self._context.shutdown()


@pytest.fixture
def peer():
    peer = Peer()
    yield peer
    peer.close()


@pytest.fixture(params=installed())
def interfaces(request):
    """Each of the packages that are here: beside a sourced ROS only its own."""
    return Interfaces.of(request.param)


def description(package: str, name: str) -> dict[str, Any]:
    """What the package says of a type, for programs."""
    file = Path(get_package_share_directory(package), f"{name}.json")
    made: dict[str, Any] = json.loads(file.read_text())
    return made


@pytest.mark.parametrize("name", TYPE_HASHES)
def test_type_hash_is_that_of_the_original(interfaces, name):
    hashes = {
        entry["type_name"]: entry["hash_string"]
        for entry in description(interfaces.package, name)["type_hashes"]
    }
    expected = HASHES[interfaces.package][name]
    assert hashes[f"{interfaces.package}/{name}"] == f"RIHS01_{expected}"


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
    received: Future = Future()
    topic = f"sent/{interfaces.package}/{name.lower()}"
    peer.node.create_subscription(kind, topic, received.set_result, 7)
    publisher = peer.node.create_publisher(kind, topic, 7)
    peer.node.create_timer(0.01, lambda: publisher.publish(message))  # until it is known
    assert peer.wait_for(received) == message
    (endpoint,) = peer.node.get_publishers_info_by_topic(topic)
    expected = HASHES[interfaces.package][f"msg/{name}"]
    assert str(endpoint.topic_type_hash) == f"RIHS01_{expected}"


@pytest.mark.parametrize("name", CALLS)
def test_service_is_called_and_answers(peer, interfaces, name):
    kind = getattr(interfaces.srv, name)
    asked, answered = CALLS[name]
    request_, response = kind.Request(**asked), kind.Response(**answered)
    requests = []

    def answer(incoming: Any, _: Any) -> Any:
        requests.append(incoming)
        return response

    peer.node.create_service(kind, f"sent/{interfaces.package}/{name.lower()}", answer)
    client = peer.node.create_client(kind, f"sent/{interfaces.package}/{name.lower()}")
    assert client.wait_for_service(DEADLINE_S)
    assert peer.wait_for(client.call_async(request_)) == response
    assert requests == [request_]


def test_action_gives_feedback_and_a_result(peer, interfaces):
    kind = interfaces.action.RotateAbsolute

    def execute(goal: Any) -> Any:
        goal.publish_feedback(kind.Feedback(remaining=goal.request.theta))
        goal.succeed()
        return kind.Result(delta=-goal.request.theta)

    feedback: Future = Future()
    ActionServer(peer.node, kind, "sent/rotate_absolute", execute)
    client = ActionClient(peer.node, kind, "sent/rotate_absolute")
    assert client.wait_for_server(DEADLINE_S)
    goal = peer.wait_for(
        client.send_goal_async(
            kind.Goal(theta=1.5),
            lambda message: feedback.set_result(message.feedback),
        )
    )
    assert peer.wait_for(goal.get_result_async()).result == kind.Result(delta=-1.5)
    assert peer.wait_for(feedback) == kind.Feedback(remaining=1.5)


def test_a_node_describes_the_type_to_others(peer, interfaces):
    package = interfaces.package
    peer.node.create_publisher(interfaces.msg.Pose, "described", 7)
    client = peer.node.create_client(GetTypeDescription, "/peer/get_type_description")
    assert client.wait_for_service(DEADLINE_S)
    answer = peer.wait_for(
        client.call_async(
            GetTypeDescription.Request(
                type_name=f"{package}/msg/Pose", type_hash=f"RIHS01_{HASHES[package]['msg/Pose']}"
            )
        )
    )
    assert answer.successful, answer.failure_reason
    fields = [field.name for field in answer.type_description.type_description.fields]
    assert fields == ["x", "y", "theta", "linear_velocity", "angular_velocity"]
    assert [source.type_name for source in answer.type_sources] == [f"{package}/msg/Pose"]
