"""The node of the scene: robot_state_publisher as others hear it, and whoever listens to tf."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from builtin_interfaces.msg import Time
from geometry_msgs.msg import Quaternion, Transform, TransformStamped, Vector3
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from std_msgs.msg import Header, String
from tf2_msgs.msg import TFMessage

from grader.scenes import cdr
from grader.scenes.robot import decoding
from grader.scenes.robot.recorder import Recorder
from grader.scenes.robot.trace import DESCRIPTION, JOINT_STATES, TF, TF_STATIC
from robot_py import robot_state
from robot_py.robot_state import Placed, Robot, RobotState

NAME = "robot_state_publisher"
#: As many as a submission may send between two ticks; the original keeps 5, and is never late.
DEPTH = 1000
LASTING = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
#: What is heard goes by how robot_state_publisher and tf2's listener ask for it.
AS_STATE_PUBLISHER = QoSProfile(depth=DEPTH, reliability=ReliabilityPolicy.BEST_EFFORT)
AS_LISTENER = QoSProfile(depth=DEPTH)
AS_STATIC_LISTENER = QoSProfile(depth=DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)

#: Topic -> the bytes in which its messages are recorded.
BYTES: dict[str, Callable[[Any], bytes]] = {
    JOINT_STATES: decoding.joint_state_bytes,
    TF: decoding.tf_bytes,
    TF_STATIC: decoding.tf_bytes,
    DESCRIPTION: lambda message: cdr.string(message.data),
}


class StateNode(Node):
    """Publishes the description and the robot's frames, and has everything recorded.

    It serves nothing, not even its parameters: all that a run hears is in the recording.
    """

    def __init__(self, description: str, recorder: Recorder) -> None:
        super().__init__(NAME, start_parameter_services=False, enable_rosout=False)
        self._recorder = recorder
        self._state = RobotState(Robot.of(description))
        self._publishers_of = {
            DESCRIPTION: self.create_publisher(String, DESCRIPTION, LASTING),
            TF: self.create_publisher(TFMessage, TF, 100),
            TF_STATIC: self.create_publisher(TFMessage, TF_STATIC, LASTING),
        }
        self._heard: list[tuple[str, Any]] = [
            (topic, self.create_subscription(kind, topic, lambda _: None, qos))
            for topic, kind, qos in (
                (JOINT_STATES, JointState, AS_STATE_PUBLISHER),
                (TF, TFMessage, AS_LISTENER),
                (TF_STATIC, TFMessage, AS_STATIC_LISTENER),
                (DESCRIPTION, String, AS_STATIC_LISTENER),
            )
        ]
        now_ns = int(self.get_clock().now().nanoseconds)
        self._send(DESCRIPTION, String(data=description))
        fixed = self._state.robot.fixed("", now_ns)
        self._send(TF_STATIC, _tf_message(fixed))

    def serve(self, now_ns: int) -> None:
        """Take what has arrived, answer the joint states of it."""
        for topic, subscription in self._heard:
            for message in _arrived(subscription):
                self._on(topic, message, now_ns)

    def _on(self, topic: str, message: Any, now_ns: int) -> None:
        is_theirs = self._recorder.hears(topic, BYTES[topic](message))
        if topic == JOINT_STATES and is_theirs:
            self._answer(message, now_ns)

    def _answer(self, message: JointState, now_ns: int) -> None:
        stamp = message.header.stamp
        state = robot_state.JointState(
            stamp.sec * 1_000_000_000 + stamp.nanosec, list(message.name), list(message.position)
        )
        transforms = self._state.hear(state, now_ns).transforms
        if transforms is not None:
            self._send(TF, _tf_message(transforms))

    def _send(self, topic: str, message: Any) -> None:
        self._recorder.publishes(topic, BYTES[topic](message))
        self._publishers_of[topic].publish(message)


def _arrived(subscription: Any) -> Iterator[Any]:
    """All that has arrived, without an executor: nothing here waits."""
    while (taken := subscription.handle.take_message(subscription.msg_type, False)) is not None:
        yield taken[0]


def _tf_message(placed: tuple[Placed, ...]) -> TFMessage:
    return TFMessage(
        transforms=[
            TransformStamped(
                header=Header(stamp=_time(each.stamp_ns), frame_id=each.frame),
                child_frame_id=each.child_frame,
                transform=Transform(
                    translation=Vector3(**dict(zip("xyz", each.translation, strict=True))),
                    rotation=Quaternion(**dict(zip("xyzw", each.rotation, strict=True))),
                ),
            )
            for each in placed
        ]
    )


def _time(stamp_ns: int) -> Time:
    sec, nanosec = divmod(stamp_ns, 1_000_000_000)
    return Time(sec=sec, nanosec=nanosec)
