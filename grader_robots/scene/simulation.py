"""The scene at work: its node, served in each tick, a recorder, and the rule for the end."""

from __future__ import annotations

from typing import Any

from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import JointState
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from grader.recording import serialise
from grader.scenes import Forecast, Hooks, Limits, Reason, Simulation, arrived
from grader.text import Message
from grader_robots.robot_py.robot_state_publisher import LATCHED, tf_message
from grader_robots.scene.trace import (
    DESCRIPTION,
    JOINT_STATES,
    TF,
    TF_STATIC,
    RobotRecorder,
    RobotTrace,
)

NAME = "robot_state_publisher"
#: As many as a submission may send between two ticks; the original keeps 5, and is never late.
DEPTH = 1000
#: What is heard goes by how robot_state_publisher and tf2's listener ask for it.
AS_STATE_PUBLISHER = QoSProfile(depth=DEPTH, reliability=ReliabilityPolicy.BEST_EFFORT)
AS_LISTENER = QoSProfile(depth=DEPTH)
AS_STATIC_LISTENER = QoSProfile(depth=DEPTH, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class RobotSimulation(Simulation):
    """See `grader.scenes.scene.Simulation`.

    Attributes:
        node: `/robot_state_publisher`.
    """

    def __init__(self, limits: Limits, hooks: Hooks, description: str) -> None:
        super().__init__()
        self._hooks = hooks
        self._recorder = RobotRecorder(description)
        self.node = StateNode(description, self._recorder)
        self._limits = limits

    @property
    def flags(self) -> tuple[Message, ...]:
        """What of the submission's messages was not taken."""
        return self._recorder.flags

    @property
    def ticks(self) -> int:
        return self._recorder.ticks

    def tick(self, now_ns: int | None = None) -> Reason:
        """Serve what has arrived, let a tick pass; why the run is over, or ''."""
        if now_ns is None:
            now_ns = int(self.node.get_clock().now().nanoseconds)
        if self._hooks.has_unread():
            self.node.serve(now_ns)
        return self._pass()

    def _pass(self) -> Reason:
        if not self.records:
            return ""
        self._recorder.ticks += 1
        return self._over(self._recorder.ticks)

    def _over(self, tick: int) -> Reason:
        return self.over(tick, self._limits, bool(self._recorder.heard))

    def foresee(self, most: int) -> Forecast:
        """The next ticks: nothing is published but in answer to a joint state."""
        first = self._recorder.ticks + 1
        count = 0
        while count < most and not self._over(first + count):
            count += 1
        return Forecast((), [()] * count)

    def pass_tick(self, now_ns: int) -> tuple[Reason, tuple[bytes, ...]]:
        """As `tick`, where nothing has arrived."""
        return self._pass(), ()

    def trace(self) -> RobotTrace:
        return self._recorder.trace()


class StateNode(Node):
    """Publishes the description and the robot's frames, and has everything recorded.

    It serves nothing, not even its parameters: all that a run hears is in the recording.
    """

    def __init__(self, description: str, recorder: RobotRecorder) -> None:
        super().__init__(NAME, start_parameter_services=False, enable_rosout=False)
        self._recorder = recorder
        self._publishers_of = {
            DESCRIPTION: self.create_publisher(String, DESCRIPTION, LATCHED),
            TF: self.create_publisher(TFMessage, TF, 100),
            TF_STATIC: self.create_publisher(TFMessage, TF_STATIC, LATCHED),
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
        self._send(TF_STATIC, tf_message(recorder.fixed(now_ns)))

    def serve(self, now_ns: int) -> None:
        """Take what has arrived, answer the joint states of it."""
        for topic, subscription in self._heard:
            for message in arrived(subscription):
                answer = self._recorder.answer(topic, serialise(message), now_ns)
                if answer is not None:
                    self._send(TF, tf_message(answer))

    def _send(self, topic: str, message: Any) -> None:
        self._recorder.publishes(topic, serialise(message))
        self._publishers_of[topic].publish(message)
