"""rclpy's action clients and servers, with our mail between them and DDS (see `endpoints`)."""

from __future__ import annotations

from typing import Any

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

from grader.run.lockstep import endpoints, waitsets
from grader.run.lockstep.endpoints import Mailed, deepened, profile, ros_type, some, weakly
from grader.run.lockstep.registry import Inbox, Outlet
from grader.run.student.scheduler import NEVER

_ActionClient, _ActionServer = _rclpy.ActionClient, _rclpy.ActionServer
_LIBRARY = "librcl_action.so"


def install() -> None:
    """Put the classes of this module into rclpy's extension module; after `endpoints`."""
    _rclpy.ActionClient = ActionClient
    _rclpy.ActionServer = ActionServer


class _Action(Mailed):
    """Makes the ends of an action."""

    def prepare(self, node: Any, action_type: type, name: str) -> None:
        """Remember what every end needs; before any other method."""
        self._node, self._name, self._type = node, name, ros_type(action_type)

    def wire(self, kind: str, part: str) -> str:
        """The wire of a part of the action; a part's name can be remapped like any other."""
        name = f"{self._name}/_action/{part}"
        is_service = kind != "topic"
        return f"{kind} {_rclpy.rclpy_resolve_name(self._node, name, False, is_service)}"

    def outlet(self, kind: str, part: str, c_qos: Any, matches: Any = None) -> Outlet:
        """A writer."""
        return Outlet(self.wire(kind, part), self._type, profile(c_qos), matches)

    def inbox(self, kind: str, part: str, c_qos: Any, take: Any, matches: Any = None) -> Inbox:
        """A reader."""
        wire = self.wire(kind, part)
        inbox = Inbox(wire, self._type, profile(c_qos), matches, take)
        if kind == "response":
            inbox.tally = endpoints.OFFICE.tally(wire)
        return inbox

    def send(self, outlet: Outlet, method: Any, *args: Any) -> Any:
        """Send and count."""
        endpoints.OFFICE.before_send(outlet)
        result = method(self, *args)
        endpoints.OFFICE.after_send(outlet)
        return result

    def count(self, question: str, wire: str) -> Any:
        """Whether the graph knows exactly so many others on a wire."""
        ask = weakly(self._node, getattr(type(self._node), question), wire.partition(" ")[2])
        return lambda number: ask() == number


class ActionClient(_Action, _rclpy.ActionClient):
    """An action client that counts, and takes from inboxes."""

    def __init__(
        self, node: Any, kind: Any, name: str, goal: Any, result: Any, cancel: Any, *topics: Any
    ) -> None:
        deep = (deepened(c_qos) for c_qos in (goal, result, cancel, *topics))
        _ActionClient.__init__(self, node, kind, name, *deep)
        self.prepare(node, kind, name)
        impl = kind.Impl
        found = weakly(self, _ActionClient.is_action_server_available)

        def matches(number: int) -> bool:
            return bool(found() == bool(number))

        def taking(method: Any, what: type) -> Any:
            return weakly(self, some(method), what)

        self.goal = self.outlet("request", "send_goal", goal, matches)
        self.cancel = self.outlet("request", "cancel_goal", cancel)
        self.result = self.outlet("request", "get_result", result)
        take_goal = taking(_ActionClient.take_goal_response, impl.SendGoalService.Response)
        take_cancel = taking(_ActionClient.take_cancel_response, impl.CancelGoalService.Response)
        take_result = taking(_ActionClient.take_result_response, impl.GetResultService.Response)
        self.goals = self.inbox("response", "send_goal", goal, take_goal)
        self.cancels = self.inbox("response", "cancel_goal", cancel, take_cancel)
        self.results = self.inbox("response", "get_result", result, take_result)
        take_feedback = weakly(self, _ActionClient.take_feedback, impl.FeedbackMessage)
        take_status = weakly(self, _ActionClient.take_status, impl.GoalStatusMessage)
        self.feedback = self.inbox("topic", "feedback", topics[0], take_feedback)
        self.status = self.inbox("topic", "status", topics[1], take_status)
        for part in ("goal_client", "cancel_client", "result_client"):
            self._hang(part)
        for part in ("feedback_subscription", "status_subscription"):
            self._hang(part)
        self.inboxes = [self.feedback, self.status, self.goals, self.cancels, self.results]
        self.register(self.goal, self.cancel, self.result, *self.inboxes)

    def _hang(self, part: str) -> None:
        function = f"rcl_action_client_set_{part}_callback"
        endpoints.OFFICE.bell.hang(function, self.pointer, _LIBRARY)

    def is_action_server_available(self) -> bool:
        """As in rclpy."""
        endpoints.OFFICE.before_question()
        return bool(_ActionClient.is_action_server_available(self))

    def send_goal_request(self, request: Any) -> Any:
        """Send and count."""
        return self.send(self.goal, _ActionClient.send_goal_request, request)

    def send_cancel_request(self, request: Any) -> Any:
        """Send and count."""
        return self.send(self.cancel, _ActionClient.send_cancel_request, request)

    def send_result_request(self, request: Any) -> Any:
        """Send and count."""
        return self.send(self.result, _ActionClient.send_result_request, request)

    def take_goal_response(self, _: type) -> Any:
        """The oldest, or (None, None)."""
        return self.goals.pop() or (None, None)

    def take_cancel_response(self, _: type) -> Any:
        """The oldest, or (None, None)."""
        return self.cancels.pop() or (None, None)

    def take_result_response(self, _: type) -> Any:
        """The oldest, or (None, None)."""
        return self.results.pop() or (None, None)

    def take_feedback(self, _: type) -> Any:
        """The oldest, or None."""
        return self.feedback.pop()

    def take_status(self, _: type) -> Any:
        """The oldest, or None."""
        return self.status.pop()

    def add_to_waitset(self, wait_set: Any) -> None:
        """Have a wait set look at our inboxes."""
        wait_set.add_inboxes(self.inboxes)

    def is_ready(self, _: Any) -> tuple[bool, ...]:
        """Whether there is feedback, a status, a response to a goal, a cancel, a result."""
        return tuple(bool(inbox.items) for inbox in self.inboxes)


class ActionServer(_Action, _rclpy.ActionServer):
    """An action server that takes from inboxes, and counts."""

    def __init__(
        self, node: Any, clock: Any, kind: Any, name: str, goal: Any, result: Any, cancel: Any,
        feedback: Any, status: Any, result_timeout: float,
    ) -> None:  # fmt: skip
        deep = (deepened(c_qos) for c_qos in (goal, result, cancel))
        waitsets.WAITER.tell_time(clock)
        self._timeout_ns = int(result_timeout * 1e9)
        self._first_expiry_ns = NEVER
        _ActionServer.__init__(
            self, node, clock, kind, name, *deep, feedback, status, result_timeout
        )
        self.prepare(node, kind, name)
        parts = (
            ("send_goal", goal, _ActionServer.take_goal_request, kind.Impl.SendGoalService),
            ("cancel_goal", cancel, _ActionServer.take_cancel_request, kind.Impl.CancelGoalService),
            ("get_result", result, _ActionServer.take_result_request, kind.Impl.GetResultService),
        )
        self.inboxes, self.answers = [], []
        for part, c_qos, method, service in parts:
            wire = self.wire("request", part)
            take = weakly(self, some(method), service.Request)
            matches = self.count("get_count_clients", wire)
            self.inboxes.append(self.inbox("request", part, c_qos, take, matches))
            self.answers.append(self.outlet("response", part, c_qos))
        self.feedback = self._topic("feedback", feedback)
        self.status = self._topic("status", status)
        for part in ("goal", "cancel", "result"):
            function = f"rcl_action_server_set_{part}_service_callback"
            endpoints.OFFICE.bell.hang(function, self.pointer, _LIBRARY)
        self.register(*self.inboxes, *self.answers, self.feedback, self.status)

    def _topic(self, part: str, c_qos: Any) -> Outlet:
        wire = self.wire("topic", part)
        return self.outlet("topic", part, c_qos, self.count("get_count_subscribers", wire))

    def take_goal_request(self, _: type) -> Any:
        """The oldest, or (None, None)."""
        return self.inboxes[0].pop() or (None, None)

    def take_cancel_request(self, _: type) -> Any:
        """The oldest, or (None, None)."""
        return self.inboxes[1].pop() or (None, None)

    def take_result_request(self, _: type) -> Any:
        """The oldest, or (None, None)."""
        return self.inboxes[2].pop() or (None, None)

    def send_goal_response(self, *args: Any) -> Any:
        """Send and count."""
        return self.send(self.answers[0], _ActionServer.send_goal_response, *args)

    def send_cancel_response(self, *args: Any) -> Any:
        """Send and count."""
        return self.send(self.answers[1], _ActionServer.send_cancel_response, *args)

    def send_result_response(self, *args: Any) -> Any:
        """Send and count."""
        return self.send(self.answers[2], _ActionServer.send_result_response, *args)

    def publish_feedback(self, message: Any) -> None:
        """Publish and count."""
        self.send(self.feedback, _ActionServer.publish_feedback, message)

    def publish_status(self) -> None:
        """Publish and count."""
        self.send(self.status, _ActionServer.publish_status)

    def notify_goal_done(self) -> None:
        """As in rclpy; its result will expire."""
        _ActionServer.notify_goal_done(self)
        expiry_ns = endpoints.NOW_NS() + self._timeout_ns
        self._first_expiry_ns = min(self._first_expiry_ns, expiry_ns)

    def expire_goals(self, most: int) -> Any:
        """As in rclpy."""
        self._first_expiry_ns = NEVER
        return _ActionServer.expire_goals(self, most)

    def add_to_waitset(self, wait_set: Any) -> None:
        """Have a wait set look at our inboxes."""
        wait_set.add_inboxes(self.inboxes)

    def is_ready(self, _: Any) -> tuple[bool, ...]:
        """Whether there is a goal, a cancel request, a result request, an expired goal."""
        has_expired = endpoints.NOW_NS() > self._first_expiry_ns
        return (*(bool(inbox.items) for inbox in self.inboxes), has_expired)
