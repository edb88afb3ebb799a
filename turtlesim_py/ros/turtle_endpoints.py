"""The topics and services of one turtle, and its action."""

from __future__ import annotations

from collections.abc import Callable
from struct import Struct
from typing import Any

from geometry_msgs.msg import Twist
from rclpy.qos import QoSProfile

from turtlesim_py.ros.interfaces import Interfaces
from turtlesim_py.ros.rclcpp_node import RclcppNode
from turtlesim_py.ros.rotate_action import RotateAction
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.turtle import Pose, Reading

#: Reliable and volatile, the last 7 messages: the original's choice for every topic.
TOPIC_QOS = QoSProfile(depth=7)
#: Pose and Color as they travel: behind a header, five singles or three bytes. The way through a
#: message object would be the dearest part of a tick. They are the same under both names.
CDR = b"\0\1\0\0"  # little-endian
POSE_BYTES = Struct("<4s5f")
COLOR_BYTES = Struct("<4s3Bx")


def pose_bytes(pose: Pose) -> bytes:
    """A pose in CDR."""
    return POSE_BYTES.pack(CDR, *pose)


class TurtleEndpoints:
    """What the graph sees of the turtle `name`, below the topic prefix of the same name.

    Attributes:
        pose_publisher: of `pose`.
        action: `rotate_absolute`.
    """

    def __init__(
        self,
        node: RclcppNode,
        interfaces: Interfaces,
        arena: Arena,
        name: str,
        accepts_goal: Callable[[], bool],
    ) -> None:
        self._node = node
        self._arena = arena
        self._name = name
        self.pose_publisher = self._publisher(interfaces.Pose, f"{name}/pose")
        self._color_publisher = self._publisher(interfaces.Color, f"{name}/color_sensor")
        cmd_vel = f"{name}/cmd_vel"
        self._subscription = node.create_subscription(
            Twist,
            cmd_vel,
            self._on_cmd_vel,
            TOPIC_QOS,
            event_callbacks=node.warn_publishers(cmd_vel),
        )
        self._services = [
            node.create_service(service, f"{name}/{called}", callback)
            for service, called, callback in (
                (interfaces.SetPen, "set_pen", self._on_set_pen),
                (interfaces.TeleportAbsolute, "teleport_absolute", self._on_teleport_absolute),
                (interfaces.TeleportRelative, "teleport_relative", self._on_teleport_relative),
            )
        ]
        self.action = RotateAction(node, interfaces, arena, name, accepts_goal)

    def publish(self, reading: Reading) -> None:
        """Send a tick's pose and colour."""
        self.pose_publisher.publish(pose_bytes(reading.pose))
        self._color_publisher.publish(COLOR_BYTES.pack(CDR, *reading.color))

    def destroy(self) -> None:
        """Take everything off the graph."""
        self.action.destroy()
        for service in self._services:
            self._node.destroy_service(service)
        self._node.destroy_subscription(self._subscription)
        self._node.destroy_publisher(self.pose_publisher)
        self._node.destroy_publisher(self._color_publisher)

    def _publisher(self, message_type: type, topic: str) -> Any:
        return self._node.create_publisher(
            message_type, topic, TOPIC_QOS, event_callbacks=self._node.warn_subscribers(topic)
        )

    def _on_cmd_vel(self, message: Twist) -> None:
        linear, angular = message.linear, message.angular
        self._arena.command(
            self._name, (linear.x, linear.y, linear.z), (angular.x, angular.y, angular.z)
        )

    def _on_set_pen(self, request: Any, response: Any) -> Any:
        self._arena.set_pen(self._name, request.r, request.g, request.b, request.width, request.off)
        return response

    def _on_teleport_absolute(self, request: Any, response: Any) -> Any:
        self._arena.teleport_absolute(self._name, request.x, request.y, request.theta)
        return response

    def _on_teleport_relative(self, request: Any, response: Any) -> Any:
        self._arena.teleport_relative(self._name, request.linear, request.angular)
        return response
