"""rclpy's action clients and servers, whose messages go by our registry (see `endpoints`)."""

from __future__ import annotations

import weakref
from collections.abc import Callable
from typing import Any, TypeVar

from action_msgs.msg import GoalStatus, GoalStatusArray
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

from grader.run.lockstep import endpoints, waitsets
from grader.run.lockstep.endpoints import (
    Node,
    Registered,
    pop,
    profile,
    request_id,
    ros_type,
    serialized,
)
from grader.run.lockstep.faults import pass_on
from grader.run.lockstep.matching import Reader, Writer
from grader.run.lockstep.protocol import NEVER

_ActionClient, _ActionServer = _rclpy.ActionClient, _rclpy.ActionServer
_GoalHandle = _rclpy.ActionGoalHandle
Made = TypeVar("Made", Reader, Writer)


def install() -> None:
    """Put the classes of this module into rclpy's extension module; after `endpoints`."""
    _rclpy.ActionClient = ActionClient
    _rclpy.ActionServer = ActionServer
    _rclpy.ActionGoalHandle = ActionGoalHandle


#: The services of an action by the words of rclpy's methods, and their names below the action's.
SERVICES = {"goal": "send_goal", "cancel": "cancel_goal", "result": "get_result"}


class _Action(Registered):
    """Makes the endpoints of an action."""

    def prepare(self, node: Node, action_type: Any, name: str) -> None:
        """Store what every endpoint needs; call this first."""
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
        """Return the channel of a part of the action; its name can be remapped like any other."""
        name = f"{self._name}/_action/{part}"
        is_service = kind != "topic"
        return f"{kind} {_rclpy.rclpy_resolve_name(self._node, name, False, is_service)}"

    def writer(self, kind: str, part: str, c_qos: Any) -> Writer:
        """Make a writer of a part of the action."""
        return Writer(self.channel(kind, part), ros_type(self._types[part]), profile(c_qos))

    def reader(self, kind: str, part: str, c_qos: Any) -> Reader:
        """Make a reader of a part of the action."""
        part_type = self._types[part]
        message = part_type if kind == "topic" else getattr(part_type, kind.capitalize())
        return Reader(
            self.channel(kind, part), ros_type(part_type), profile(c_qos), message=message
        )

    def of_services(self, make: Callable[..., Made], kind: str, *c_qos: Any) -> dict[str, Made]:
        """Make an endpoint of each service, in the order of `SERVICES`."""
        pairs = zip(SERVICES.items(), c_qos, strict=True)
        return {service: make(kind, part, each) for (service, part), each in pairs}


def _sends_request(service: str) -> Callable[[ActionClient, Any], int]:
    """Return the method that sends a request of one of an action's services."""
    method = getattr(_ActionClient, f"send_{service}_request")

    def send(self: ActionClient, request: Any) -> int:
        self.connect(method, request)
        writer, reader = self.requests[service], self.responses[service]
        return endpoints.REGISTRY.ask(writer, reader, serialized(request))

    return send


def _pops_response(service: str) -> Callable[[ActionClient, type], Any]:
    """Return the method that pops the oldest response after its number, or (None, None)."""
    return lambda self, _: pop(self.responses[service], lambda item: item.number)


class ActionClient(_Action, _rclpy.ActionClient):
    """An action client that reads from our readers."""

    def __init__(
        self, node: Node, kind: Any, name: str, goal: Any, result: Any, cancel: Any,
        feedback: Any, status: Any, *more: Any,
    ) -> None:  # fmt: skip
        profiles = (goal, result, cancel, feedback, status)
        pass_on(_ActionClient.__init__, self, node, kind, name, *profiles, *more)
        self.prepare(node, kind, name)
        self.requests = self.of_services(self.writer, "request", goal, cancel, result)
        self.responses = self.of_services(self.reader, "response", goal, cancel, result)
        self.feedback = self.reader("topic", "feedback", feedback)
        self.status = self.reader("topic", "status", status)
        self.readers = [self.feedback, self.status, *self.responses.values()]
        self.register(node, *self.requests.values(), *self.readers)

    send_goal_request, send_cancel_request, send_result_request = map(_sends_request, SERVICES)
    take_goal_response, take_cancel_response, take_result_response = map(_pops_response, SERVICES)

    def is_action_server_available(self) -> bool:
        if not self.is_valid():
            return bool(pass_on(_ActionClient.is_action_server_available, self))
        registry = endpoints.REGISTRY
        registry.before_question()
        return all(map(registry.count_readers, self.requests.values())) and all(
            map(registry.count_writers, (self.feedback, self.status))
        )

    def take_feedback(self, _: type) -> Any:
        return pop(self.feedback, id)[1]

    def take_status(self, _: type) -> Any:
        return pop(self.status, id)[1]

    def add_to_waitset(self, wait_set: Any) -> None:
        wait_set.add_readers(self.readers)

    def is_ready(self, _: Any) -> tuple[bool, ...]:
        """Whether there is feedback, a status, a response to a goal, a cancel, a result."""
        return tuple(bool(reader.items) for reader in self.readers)


def _pops_request(service: str) -> Callable[[ActionServer, type], Any]:
    """Return the method that pops the oldest request after its identity, or (None, None)."""
    return lambda self, _: pop(self.requests[service], request_id)


def _sends_response(service: str) -> Callable[[ActionServer, Any, Any], None]:
    """Return the method that answers a request."""
    return lambda self, to, response: self.respond(self.responses[service], to, response)


class ActionServer(_Action, _rclpy.ActionServer):
    """An action server that reads from our readers."""

    def __init__(
        self, node: Node, clock: Any, kind: Any, name: str, goal: Any, result: Any, cancel: Any,
        feedback: Any, status: Any, result_timeout: float, *more: Any,
    ) -> None:  # fmt: skip
        waitsets.WAITER.attach_clock(clock)
        self._timeout_ns = int(result_timeout * 1e9)
        self._first_expiry_ns = NEVER
        self._goals: list[weakref.ref[ActionGoalHandle]] = []
        rest = (goal, result, cancel, feedback, status, result_timeout, *more)
        pass_on(_ActionServer.__init__, self, node, clock, kind, name, *rest)
        self.prepare(node, kind, name)
        self.requests = self.of_services(self.reader, "request", goal, cancel, result)
        self.responses = self.of_services(self.writer, "response", goal, cancel, result)
        self.feedback = self.writer("topic", "feedback", feedback)
        self.status = self.writer("topic", "status", status)
        both = (*self.requests.values(), *self.responses.values())
        self.register(node, *both, self.feedback, self.status)

    take_goal_request, take_cancel_request, take_result_request = map(_pops_request, SERVICES)
    send_goal_response, send_cancel_response, send_result_response = map(_sends_response, SERVICES)

    def publish_feedback(self, message: Any) -> None:
        self.connect(_ActionServer.publish_feedback, message)
        endpoints.REGISTRY.publish(self.feedback, serialized(message))

    def publish_status(self) -> None:
        """As in rclpy: the states of all goals that have not expired."""
        self.connect(_ActionServer.publish_status)
        goals = [goal for reference in self._goals if (goal := reference()) is not None]
        states = [
            GoalStatus(goal_info=goal.goal_info, status=int(goal.get_status())) for goal in goals
        ]
        message = GoalStatusArray(status_list=states)
        endpoints.REGISTRY.publish(self.status, serialized(message))

    def add_goal(self, goal: ActionGoalHandle) -> None:
        """Keep an accepted goal, whose status is published until it expires."""
        self._goals.append(weakref.ref(goal, self._goals.remove))

    def notify_goal_done(self) -> None:
        """As in rclpy; its result will expire."""
        _ActionServer.notify_goal_done(self)
        expiry_ns = endpoints.REGISTRY.now_ns() + self._timeout_ns
        self._first_expiry_ns = min(self._first_expiry_ns, expiry_ns)

    def expire_goals(self, most: int) -> Any:
        self._first_expiry_ns = NEVER
        return _ActionServer.expire_goals(self, most)

    def add_to_waitset(self, wait_set: Any) -> None:
        wait_set.add_readers([*self.requests.values()])

    def is_ready(self, _: Any) -> tuple[bool, ...]:
        """Whether there is a goal, a cancel request, a result request, an expired goal."""
        has_expired = endpoints.REGISTRY.now_ns() > self._first_expiry_ns
        return (*(bool(reader.items) for reader in self.requests.values()), has_expired)


class ActionGoalHandle(_rclpy.ActionGoalHandle):
    """A goal that its server knows."""

    def __init__(self, server: ActionServer, goal_info: Any) -> None:
        pass_on(_GoalHandle.__init__, self, server, goal_info)
        self.goal_info = goal_info
        server.add_goal(self)
