"""The action `rotate_absolute` of one turtle."""

from __future__ import annotations

from collections.abc import Callable

from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.action.server import GoalEvent, ServerGoalHandle
from rclpy.node import Node
from rclpy.task import Future

from turtlesim_py.ros.interfaces import Interfaces
from turtlesim_py.world.arena import Arena
from turtlesim_py.world.notices import GoalFeedback, GoalResult

#: How long a result can still be asked for [s]: rclcpp's default, which the original leaves alone.
RESULT_TIMEOUT_S = 10


class RotateAction:
    """Passes goals and cancel requests on to the arena, and what comes of them to the clients.

    Every request is accepted, and every goal where nobody says otherwise. In rclpy an execute
    callback turns a goal into a result; here the world does, in the middle of its ticks, so there
    is no such callback, and `finish` sets the state and the waiting result itself.
    """

    def __init__(
        self,
        node: Node,
        interfaces: Interfaces,
        arena: Arena,
        turtle: str,
        accepts: Callable[[], bool],
    ) -> None:
        """`accepts` is asked before each goal."""
        self._type = interfaces.RotateAbsolute
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
        """How many goals are known: what runs, and what has ended and can still be asked for."""
        return len(self._server._goal_handles)

    def feedback(self, event: GoalFeedback) -> None:
        """Tell a goal's client how far it still is."""
        message = self._type.Feedback(remaining=event.remaining_rad)
        handle, _ = self._running[_key(event)]
        handle.publish_feedback(message)

    def finish(self, event: GoalResult) -> None:
        """End a goal and send its result to those who wait for it."""
        handle, awaited = self._running.pop(_key(event))
        if event.status == "SUCCEEDED":
            handle.succeed()
        elif event.status == "ABORTED":
            handle.abort()
        else:
            if not handle.is_cancel_requested:  # the turtle is gone, nobody has asked
                handle._update_state(GoalEvent.CANCEL_GOAL)
            handle.canceled()
        response = self._type.Impl.GetResultService.Response(
            status=handle.status, result=self._type.Result(delta=event.delta_rad)
        )
        awaited.set_result(response)

    def destroy(self) -> None:
        """Take the action off the graph."""
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
