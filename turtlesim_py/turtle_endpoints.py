"""The topics, services and the action of one turtle."""

from __future__ import annotations

from typing import Any

from geometry_msgs.msg import Twist
from rclpy.action import ActionServer, CancelResponse
from rclpy.action.server import ServerGoalHandle
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.node import Node
from rclpy.qos import QoSProfile
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Color, Pose
from turtlesim.srv import SetPen, TeleportAbsolute, TeleportRelative

from turtlesim_py.world.arena import Arena
from turtlesim_py.world.events import GoalFeedback, GoalResult
from turtlesim_py.world.turtle import Reading

#: Reliable and volatile, the last 7 messages: the original's choice for every topic.
TOPIC_QOS = QoSProfile(depth=7)

GoalEvent = _rclpy.GoalEvent


class TurtleEndpoints:
    """What the graph sees of the turtle `name`, below the topic prefix of the same name."""

    def __init__(self, node: Node, arena: Arena, name: str) -> None:
        self._node = node
        self._arena = arena
        self._name = name
        self._goals: dict[bytes, ServerGoalHandle] = {}
        self._pose = Pose()
        self._color = Color()
        self._pose_publisher = node.create_publisher(Pose, f"{name}/pose", TOPIC_QOS)
        self._color_publisher = node.create_publisher(Color, f"{name}/color_sensor", TOPIC_QOS)
        self._subscription = node.create_subscription(
            Twist, f"{name}/cmd_vel", self._on_cmd_vel, TOPIC_QOS
        )
        self._services = [
            node.create_service(SetPen, f"{name}/set_pen", self._on_set_pen),
            node.create_service(
                TeleportAbsolute, f"{name}/teleport_absolute", self._on_teleport_absolute
            ),
            node.create_service(
                TeleportRelative, f"{name}/teleport_relative", self._on_teleport_relative
            ),
        ]
        self._action = ActionServer(
            node,
            RotateAbsolute,
            f"{name}/rotate_absolute",
            execute_callback=_never_executed,
            handle_accepted_callback=self._on_goal,
            cancel_callback=self._on_cancel,
        )

    def publish(self, reading: Reading) -> None:
        """Send a tick's pose and colour."""
        pose, color = self._pose, self._color
        pose.x, pose.y, pose.theta, pose.linear_velocity, pose.angular_velocity = reading.pose
        color.r, color.g, color.b = reading.color
        self._pose_publisher.publish(pose)
        self._color_publisher.publish(color)

    def feedback(self, event: GoalFeedback) -> None:
        """Tell a goal's client how far it still is."""
        message = RotateAbsolute.Feedback(remaining=event.remaining_rad)
        self._goals[_key(event.goal_id)].publish_feedback(message)

    def finish(self, event: GoalResult) -> None:
        """End a goal and send its result.

        rclpy ends goals only from inside an execute callback, but here the world decides, in the
        middle of a tick; so the state and the waiting result are set directly.
        """
        key = _key(event.goal_id)
        handle = self._goals.pop(key)
        if event.status == "SUCCEEDED":
            handle.succeed()
        elif event.status == "ABORTED":
            handle.abort()
        else:
            if not handle.is_cancel_requested:
                handle._update_state(GoalEvent.CANCEL_GOAL)
            handle.canceled()
        response = RotateAbsolute.Impl.GetResultService.Response()
        response.status = handle.status
        response.result = RotateAbsolute.Result(delta=event.delta_rad)
        self._action._result_futures[key].set_result(response)

    def destroy(self) -> None:
        """Take everything off the graph."""
        self._action.destroy()
        for service in self._services:
            self._node.destroy_service(service)
        self._node.destroy_subscription(self._subscription)
        self._node.destroy_publisher(self._pose_publisher)
        self._node.destroy_publisher(self._color_publisher)

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

    def _on_goal(self, handle: ServerGoalHandle) -> None:
        handle._update_state(GoalEvent.EXECUTE)
        key = bytes(handle.goal_id.uuid)
        self._goals[key] = handle
        self._arena.rotate_absolute(self._name, handle.request.theta, key)

    def _on_cancel(self, handle: ServerGoalHandle) -> CancelResponse:
        self._arena.cancel(bytes(handle.goal_id.uuid))
        return CancelResponse.ACCEPT


def _key(goal_id: object) -> bytes:
    assert isinstance(goal_id, bytes)
    return goal_id


def _never_executed(_: ServerGoalHandle) -> RotateAbsolute.Result:
    """Required by rclpy; goals advance in the world's ticks instead."""
    return RotateAbsolute.Result()
