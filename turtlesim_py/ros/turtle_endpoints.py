"""The topics and services of one turtle, and its action."""

from __future__ import annotations

from collections.abc import Callable
from struct import Struct
from typing import Any

from geometry_msgs.msg import Twist
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import GoalEvent, ServerGoalHandle
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.task import Future

from turtlesim_py.ros.interfaces import Interfaces
from turtlesim_py.ros.rclcpp_node import RclcppNode
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.events import GoalFeedback, GoalResult
from turtlesim_py.world.turtle import Pose, Reading

#: Reliable and volatile, the last 7 messages: the original's choice for every topic.
TOPIC_QOS = QoSProfile(depth=7)
#: Pose and Color in CDR: a header, then five singles or three bytes. Message objects would cost
#: more than all else in a tick. Both packages have the same types.
CDR = b"\0\1\0\0"  # little-endian
POSE_BYTES = Struct("<4s5f")
COLOR_BYTES = Struct("<4s3Bx")
#: How long a result can still be asked for [s]: rclcpp's default, which the original leaves alone.
RESULT_TIMEOUT_S = 10


def pose_bytes(pose: Pose) -> bytes:
    return POSE_BYTES.pack(CDR, *pose)


class RotateAction:
    """Passes goals and cancel requests on to the arena, and feedback and results to the clients.

    Every cancel request is accepted, and every goal that `accepts` does not refuse. In rclpy an
    execute callback turns a goal into a result; here the world does, in the middle of its ticks, so
    there is no such callback, and `finish` sets the state and the waiting result itself.
    """

    def __init__(
        self,
        node: Node,
        interfaces: Interfaces,
        arena: Arena,
        turtle: str,
        accepts: Callable[[], bool],
    ) -> None:
        """`accepts` is called before each goal."""
        self._type = interfaces.action.RotateAbsolute
        self._arena = arena
        self._turtle = turtle
        #: with the result that is waited for: rclpy forgets a goal whose number is that of one that
        #: expires in the same moment
        self._running: dict[bytes, tuple[ServerGoalHandle, Future]] = {}
        self._server = ActionServer(
            node,
            self._type,
            f"{turtle}/rotate_absolute",
            execute_callback=lambda _: None,  # never called, but required
            goal_callback=lambda _: GoalResponse.ACCEPT if accepts() else GoalResponse.REJECT,
            handle_accepted_callback=self._on_goal,
            cancel_callback=self._on_cancel,
            result_timeout=RESULT_TIMEOUT_S,
        )

    @property
    def known(self) -> int:
        """The number of known goals: running, or ended and with a result that can be requested."""
        return len(self._server._goal_handles)

    def feedback(self, event: GoalFeedback) -> None:
        """Send a goal's client the remaining angle."""
        message = self._type.Feedback(remaining=event.remaining_rad)
        handle, _ = self._running[_key(event)]
        handle.publish_feedback(message)

    def finish(self, event: GoalResult) -> None:
        """End a goal and send its result to waiting clients."""
        handle, awaited = self._running.pop(_key(event))
        if event.status == "SUCCEEDED":
            handle.succeed()
        elif event.status == "ABORTED":
            handle.abort()
        else:
            if not handle.is_cancel_requested:  # the turtle is gone, without a request
                handle._update_state(GoalEvent.CANCEL_GOAL)
            handle.canceled()
        response = self._type.Impl.GetResultService.Response(
            status=handle.status, result=self._type.Result(delta=event.delta_rad)
        )
        awaited.set_result(response)

    def destroy(self) -> None:
        """Remove the action from the graph."""
        self._server.destroy()

    def _on_goal(self, handle: ServerGoalHandle) -> None:
        handle._update_state(GoalEvent.EXECUTE)
        key = bytes(handle.goal_id.uuid)
        self._running[key] = handle, self._server._result_futures[key]
        self._arena.rotate_absolute(self._turtle, handle.request.theta, key)

    def _on_cancel(self, handle: ServerGoalHandle) -> CancelResponse:
        self._arena.cancel(bytes(handle.goal_id.uuid))
        return CancelResponse.ACCEPT


def _key(event: GoalFeedback | GoalResult) -> bytes:
    assert isinstance(event.goal_id, bytes)  # as given to the arena in _on_goal
    return event.goal_id


class TurtleEndpoints:
    """The endpoints of the turtle `name`, below the topic prefix of the same name.

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
        self.pose_publisher = self._publisher(interfaces.msg.Pose, f"{name}/pose")
        self._color_publisher = self._publisher(interfaces.msg.Color, f"{name}/color_sensor")
        cmd_vel = f"{name}/cmd_vel"
        self._subscription = node.create_subscription(
            Twist,
            cmd_vel,
            self._on_cmd_vel,
            TOPIC_QOS,
            event_callbacks=node.warn_publishers(cmd_vel),
        )
        srv = interfaces.srv
        self._services = [
            self._service(srv.SetPen, arena.set_pen, "r", "g", "b", "width", "off"),
            self._service(srv.TeleportAbsolute, arena.teleport_absolute, "x", "y", "theta"),
            self._service(srv.TeleportRelative, arena.teleport_relative, "linear", "angular"),
        ]
        self.action = RotateAction(node, interfaces, arena, name, accepts_goal)

    def publish(self, reading: Reading) -> None:
        """Send a tick's pose and colour."""
        self.pose_publisher.publish(pose_bytes(reading.pose))
        self._color_publisher.publish(COLOR_BYTES.pack(CDR, *reading.color))

    def destroy(self) -> None:
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

    def _service(self, kind: Any, act: Callable[..., None], *fields: str) -> Any:
        """Serve a method of the arena's by its name, for this turtle, with a request's fields."""

        def serve(request: Any, response: Any) -> Any:
            act(self._name, *(getattr(request, field) for field in fields))
            return response

        return self._node.create_service(kind, f"{self._name}/{act.__name__}", serve)

    def _on_cmd_vel(self, message: Twist) -> None:
        linear, angular = message.linear, message.angular
        self._arena.command(
            self._name, (linear.x, linear.y, linear.z), (angular.x, angular.y, angular.z)
        )
