"""rclpy's action clients and servers, whose messages go by our registry (see `endpoints`)."""

from __future__ import annotations

import weakref
from typing import Any

from action_msgs.msg import GoalStatus, GoalStatusArray
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

from grader.run.lockstep import endpoints, waitsets
from grader.run.lockstep.endpoints import (
    Node,
    Registered,
    deserialized,
    profile,
    request_id,
    ros_type,
    serialized,
)
from grader.run.lockstep.faults import as_python_does, pass_on
from grader.run.lockstep.registry import Reader, Writer
from grader.run.lockstep.times import NEVER

_ActionClient, _ActionServer = _rclpy.ActionClient, _rclpy.ActionServer
_GoalHandle = _rclpy.ActionGoalHandle


def install() -> None:
    """Put the classes of this module into rclpy's extension module; after `endpoints`."""
    _rclpy.ActionClient = ActionClient
    _rclpy.ActionServer = ActionServer
    _rclpy.ActionGoalHandle = ActionGoalHandle


class _Action(Registered):
    """Makes the endpoints of an action."""

    def prepare(self, node: Node, action_type: Any, name: str) -> None:
        """Remember what every endpoint needs; before any other method."""
        impl = action_type.Impl
        self._node, self._name = node, name
        #: of each part, which is a service or a topic that others may use as such
        self._types = {
            "send_goal": impl.SendGoalService,
            "cancel_goal": impl.CancelGoalService,
            "get_result": impl.GetResultService,
            "feedback": impl.FeedbackMessage,
            "status": impl.GoalStatusMessage,
        }

    def channel(self, kind: str, part: str) -> str:
        """The channel of a part of the action; a part's name can be remapped like any other."""
        name = f"{self._name}/_action/{part}"
        is_service = kind != "topic"
        return f"{kind} {_rclpy.rclpy_resolve_name(self._node, name, False, is_service)}"

    def writer(self, kind: str, part: str, c_qos: Any) -> Writer:
        """A writer."""
        return Writer(self.channel(kind, part), ros_type(self._types[part]), profile(c_qos))

    def reader(self, kind: str, part: str, c_qos: Any) -> Reader:
        """A reader."""
        part_type = self._types[part]
        messages = {"topic": "", "request": "Request", "response": "Response"}[kind]
        message = getattr(part_type, messages) if messages else part_type
        return Reader(
            self.channel(kind, part), ros_type(part_type), profile(c_qos), message=message
        )


def _take(reader: Reader) -> Any:
    """The oldest message; None if there is none."""
    item = reader.pop()
    return None if item is None else deserialized(item.data, reader.message)


class ActionClient(_Action, _rclpy.ActionClient):
    """An action client that takes from readers."""

    def __init__(
        self, node: Node, kind: Any, name: str, goal: Any, result: Any, cancel: Any,
        feedback: Any, status: Any, *more: Any,
    ) -> None:  # fmt: skip
        profiles = (goal, result, cancel, feedback, status)
        pass_on(_ActionClient.__init__, self, node, kind, name, *profiles, *more)
        self.prepare(node, kind, name)
        self.goal = self.writer("request", "send_goal", goal)
        self.cancel = self.writer("request", "cancel_goal", cancel)
        self.result = self.writer("request", "get_result", result)
        self.goals = self.reader("response", "send_goal", goal)
        self.cancels = self.reader("response", "cancel_goal", cancel)
        self.results = self.reader("response", "get_result", result)
        self.feedback = self.reader("topic", "feedback", feedback)
        self.status = self.reader("topic", "status", status)
        self.readers = [self.feedback, self.status, self.goals, self.cancels, self.results]
        self.register(node, self.goal, self.cancel, self.result, *self.readers)

    def is_action_server_available(self) -> bool:
        """As in rclpy."""
        if not self.is_valid():
            return bool(pass_on(_ActionClient.is_action_server_available, self))
        registry = endpoints.REGISTRY
        registry.before_question()
        return all(map(registry.count_readers, (self.goal, self.cancel, self.result))) and all(
            map(registry.count_writers, (self.feedback, self.status))
        )

    def send_goal_request(self, request: Any) -> int:
        """As in rclpy."""
        endpoints.REGISTRY.connect()
        if not self.is_valid():
            pass_on(_ActionClient.send_goal_request, self, request)
        return endpoints.REGISTRY.ask(self.goal, self.goals, serialized(request))

    def send_cancel_request(self, request: Any) -> int:
        """As in rclpy."""
        endpoints.REGISTRY.connect()
        if not self.is_valid():
            pass_on(_ActionClient.send_cancel_request, self, request)
        return endpoints.REGISTRY.ask(self.cancel, self.cancels, serialized(request))

    def send_result_request(self, request: Any) -> int:
        """As in rclpy."""
        endpoints.REGISTRY.connect()
        if not self.is_valid():
            pass_on(_ActionClient.send_result_request, self, request)
        return endpoints.REGISTRY.ask(self.result, self.results, serialized(request))

    def take_goal_response(self, _: type) -> Any:
        """The oldest with its number, or (None, None)."""
        return _take_response(self.goals)

    def take_cancel_response(self, _: type) -> Any:
        """The oldest with its number, or (None, None)."""
        return _take_response(self.cancels)

    def take_result_response(self, _: type) -> Any:
        """The oldest with its number, or (None, None)."""
        return _take_response(self.results)

    def take_feedback(self, _: type) -> Any:
        """The oldest, or None."""
        return _take(self.feedback)

    def take_status(self, _: type) -> Any:
        """The oldest, or None."""
        return _take(self.status)

    def add_to_waitset(self, wait_set: Any) -> None:
        """Have a wait set look at our readers."""
        wait_set.add_readers(self.readers)

    def is_ready(self, _: Any) -> tuple[bool, ...]:
        """Whether there is feedback, a status, a response to a goal, a cancel, a result."""
        return tuple(bool(reader.items) for reader in self.readers)


def _take_response(reader: Reader) -> Any:
    item = reader.pop()
    if item is None:
        return None, None
    return item.number, deserialized(item.data, reader.message)


class ActionServer(_Action, _rclpy.ActionServer):
    """An action server that takes from readers."""

    def __init__(
        self, node: Node, clock: Any, kind: Any, name: str, goal: Any, result: Any, cancel: Any,
        feedback: Any, status: Any, result_timeout: float, *more: Any,
    ) -> None:  # fmt: skip
        waitsets.WAITER.tell_time(clock)
        self._timeout_ns = int(result_timeout * 1e9)
        self._first_expiry_ns = NEVER
        self._goals: list[weakref.ref[ActionGoalHandle]] = []
        rest = (goal, result, cancel, feedback, status, result_timeout, *more)
        pass_on(_ActionServer.__init__, self, node, clock, kind, name, *rest)
        self.prepare(node, kind, name)
        parts = (("send_goal", goal), ("cancel_goal", cancel), ("get_result", result))
        self.readers = [self.reader("request", part, c_qos) for part, c_qos in parts]
        self.answers = [self.writer("response", part, c_qos) for part, c_qos in parts]
        self.feedback = self.writer("topic", "feedback", feedback)
        self.status = self.writer("topic", "status", status)
        self.register(node, *self.readers, *self.answers, self.feedback, self.status)

    def take_goal_request(self, _: type) -> Any:
        """The oldest with its header, or (None, None)."""
        return _take_request(self.readers[0])

    def take_cancel_request(self, _: type) -> Any:
        """The oldest with its header, or (None, None)."""
        return _take_request(self.readers[1])

    def take_result_request(self, _: type) -> Any:
        """The oldest with its header, or (None, None)."""
        return _take_request(self.readers[2])

    def send_goal_response(self, to: Any, response: Any) -> None:
        """As in rclpy."""
        self._respond(self.answers[0], to, response)

    def send_cancel_response(self, to: Any, response: Any) -> None:
        """As in rclpy."""
        self._respond(self.answers[1], to, response)

    def send_result_response(self, to: Any, response: Any) -> None:
        """As in rclpy."""
        self._respond(self.answers[2], to, response)

    def _respond(self, writer: Writer, to: Any, response: Any) -> None:
        if not self.is_valid():
            as_python_does(_rclpy.RCLError("failed to send response: rclpy is shut down"))
        endpoints.REGISTRY.respond(writer, to.request, serialized(response))

    def publish_feedback(self, message: Any) -> None:
        """As in rclpy."""
        endpoints.REGISTRY.connect()
        if not self.is_valid():
            pass_on(_ActionServer.publish_feedback, self, message)
        endpoints.REGISTRY.publish(self.feedback, serialized(message))

    def publish_status(self) -> None:
        """As in rclpy: the states of all goals that have not expired."""
        endpoints.REGISTRY.connect()
        if not self.is_valid():
            pass_on(_ActionServer.publish_status, self)
        goals = [goal for reference in self._goals if (goal := reference()) is not None]
        states = [
            GoalStatus(goal_info=goal.goal_info, status=int(goal.get_status())) for goal in goals
        ]
        message = GoalStatusArray(status_list=states)
        endpoints.REGISTRY.publish(self.status, serialized(message))

    def add_goal(self, goal: ActionGoalHandle) -> None:
        """A goal was accepted."""
        self._goals.append(weakref.ref(goal, self._goals.remove))

    def notify_goal_done(self) -> None:
        """As in rclpy; its result will expire."""
        _ActionServer.notify_goal_done(self)
        expiry_ns = endpoints.REGISTRY.now_ns() + self._timeout_ns
        self._first_expiry_ns = min(self._first_expiry_ns, expiry_ns)

    def expire_goals(self, most: int) -> Any:
        """As in rclpy."""
        self._first_expiry_ns = NEVER
        return _ActionServer.expire_goals(self, most)

    def add_to_waitset(self, wait_set: Any) -> None:
        """Have a wait set look at our readers."""
        wait_set.add_readers(self.readers)

    def is_ready(self, _: Any) -> tuple[bool, ...]:
        """Whether there is a goal, a cancel request, a result request, an expired goal."""
        has_expired = endpoints.REGISTRY.now_ns() > self._first_expiry_ns
        return (*(bool(reader.items) for reader in self.readers), has_expired)


def _take_request(reader: Reader) -> Any:
    item = reader.pop()
    if item is None:
        return None, None
    return request_id(item), deserialized(item.data, reader.message)


class ActionGoalHandle(_rclpy.ActionGoalHandle):
    """A goal that its server knows."""

    def __init__(self, server: ActionServer, goal_info: Any) -> None:
        pass_on(_GoalHandle.__init__, self, server, goal_info)
        self.goal_info = goal_info
        server.add_goal(self)
