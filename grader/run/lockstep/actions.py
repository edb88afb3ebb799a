"""rclpy's action clients and servers, counted and served by us (see `endpoints`)."""

from __future__ import annotations

from typing import Any

from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

from grader.run.lockstep import endpoints, waitsets
from grader.run.lockstep.endpoints import (
    Registered,
    deepened,
    matching,
    profile,
    ros_type,
    some,
    weakly,
)
from grader.run.lockstep.faults import pass_on
from grader.run.lockstep.registry import Reader, Writer
from grader.run.lockstep.times import NEVER

_ActionClient, _ActionServer = _rclpy.ActionClient, _rclpy.ActionServer
_LIBRARY = "librcl_action.so"


def install() -> None:
    """Put the classes of this module into rclpy's extension module; after `endpoints`."""
    _rclpy.ActionClient = ActionClient
    _rclpy.ActionServer = ActionServer


class _Action(Registered):
    """Makes the endpoints of an action."""

    def prepare(self, node: Any, action_type: type, name: str) -> None:
        """Remember what every endpoint needs; before any other method."""
        self._node, self._name, self._type = node, name, ros_type(action_type)

    def channel(self, kind: str, part: str) -> str:
        """The channel of a part of the action; a part's name can be remapped like any other."""
        name = f"{self._name}/_action/{part}"
        is_service = kind != "topic"
        return f"{kind} {_rclpy.rclpy_resolve_name(self._node, name, False, is_service)}"

    def writer(self, kind: str, part: str, c_qos: Any, matches: Any = None) -> Writer:
        """A writer."""
        return Writer(self.channel(kind, part), self._type, profile(c_qos), matches)

    def reader(self, kind: str, part: str, c_qos: Any, take: Any, matches: Any = None) -> Reader:
        """A reader."""
        channel = self.channel(kind, part)
        reader = Reader(channel, self._type, profile(c_qos), matches, take)
        if kind == "response":
            reader.arrivals = endpoints.REGISTRY.shared_arrivals(channel)
        return reader

    def send(self, writer: Writer, method: Any, *args: Any) -> Any:
        """Send and count."""
        endpoints.REGISTRY.before_send(writer)
        result = pass_on(method, self, *args)
        endpoints.REGISTRY.after_send(writer)
        return result

    def count(self, question: str, channel: str) -> Any:
        """Whether the graph knows exactly so many others on a channel."""
        ask = getattr(type(self._node), question)
        return matching(self._node, ask, channel.partition(" ")[2])


class ActionClient(_Action, _rclpy.ActionClient):
    """An action client that counts, and takes from readers."""

    def __init__(
        self, node: Any, kind: Any, name: str, goal: Any, result: Any, cancel: Any,
        feedback: Any, status: Any, *more: Any,
    ) -> None:  # fmt: skip
        deep = (deepened(c_qos) for c_qos in (goal, result, cancel, feedback, status))
        pass_on(_ActionClient.__init__, self, node, kind, name, *deep, *more)
        self.prepare(node, kind, name)
        impl = kind.Impl
        matches = matching(self, _ActionClient.is_action_server_available)

        def taking(method: Any, what: type) -> Any:
            return weakly(self, some(method), what)

        self.goal = self.writer("request", "send_goal", goal, matches)
        self.cancel = self.writer("request", "cancel_goal", cancel)
        self.result = self.writer("request", "get_result", result)
        take_goal = taking(_ActionClient.take_goal_response, impl.SendGoalService.Response)
        take_cancel = taking(_ActionClient.take_cancel_response, impl.CancelGoalService.Response)
        take_result = taking(_ActionClient.take_result_response, impl.GetResultService.Response)
        self.goals = self.reader("response", "send_goal", goal, take_goal)
        self.cancels = self.reader("response", "cancel_goal", cancel, take_cancel)
        self.results = self.reader("response", "get_result", result, take_result)
        take_feedback = weakly(self, _ActionClient.take_feedback, impl.FeedbackMessage)
        take_status = weakly(self, _ActionClient.take_status, impl.GoalStatusMessage)
        self.feedback = self.reader("topic", "feedback", feedback, take_feedback)
        self.status = self.reader("topic", "status", status, take_status)
        for part in ("goal_client", "cancel_client", "result_client"):
            self._signal_arrivals(part)
        for part in ("feedback_subscription", "status_subscription"):
            self._signal_arrivals(part)
        self.readers = [self.feedback, self.status, self.goals, self.cancels, self.results]
        self.register(self.goal, self.cancel, self.result, *self.readers)

    def _signal_arrivals(self, part: str) -> None:
        function = f"rcl_action_client_set_{part}_callback"
        endpoints.REGISTRY.arrival_signal.attach(function, self.pointer, _LIBRARY)

    def is_action_server_available(self) -> bool:
        """As in rclpy."""
        endpoints.REGISTRY.before_question()
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
        """Have a wait set look at our readers."""
        wait_set.add_readers(self.readers)

    def is_ready(self, _: Any) -> tuple[bool, ...]:
        """Whether there is feedback, a status, a response to a goal, a cancel, a result."""
        return tuple(bool(reader.items) for reader in self.readers)


class ActionServer(_Action, _rclpy.ActionServer):
    """An action server that takes from readers, and counts."""

    def __init__(
        self, node: Any, clock: Any, kind: Any, name: str, goal: Any, result: Any, cancel: Any,
        feedback: Any, status: Any, result_timeout: float, *more: Any,
    ) -> None:  # fmt: skip
        deep = (deepened(c_qos) for c_qos in (goal, result, cancel))
        waitsets.WAITER.tell_time(clock)
        self._timeout_ns = int(result_timeout * 1e9)
        self._first_expiry_ns = NEVER
        rest = (*deep, feedback, status, result_timeout, *more)
        pass_on(_ActionServer.__init__, self, node, clock, kind, name, *rest)
        self.prepare(node, kind, name)
        parts = (
            ("send_goal", goal, _ActionServer.take_goal_request, kind.Impl.SendGoalService),
            ("cancel_goal", cancel, _ActionServer.take_cancel_request, kind.Impl.CancelGoalService),
            ("get_result", result, _ActionServer.take_result_request, kind.Impl.GetResultService),
        )
        self.readers, self.answers = [], []
        for part, c_qos, method, service in parts:
            channel = self.channel("request", part)
            take = weakly(self, some(method), service.Request)
            matches = self.count("get_count_clients", channel)
            self.readers.append(self.reader("request", part, c_qos, take, matches))
            self.answers.append(self.writer("response", part, c_qos))
        self.feedback = self._topic("feedback", feedback)
        self.status = self._topic("status", status)
        for part in ("goal", "cancel", "result"):
            function = f"rcl_action_server_set_{part}_service_callback"
            endpoints.REGISTRY.arrival_signal.attach(function, self.pointer, _LIBRARY)
        self.register(*self.readers, *self.answers, self.feedback, self.status)

    def _topic(self, part: str, c_qos: Any) -> Writer:
        channel = self.channel("topic", part)
        return self.writer("topic", part, c_qos, self.count("get_count_subscribers", channel))

    def take_goal_request(self, _: type) -> Any:
        """The oldest, or (None, None)."""
        return self.readers[0].pop() or (None, None)

    def take_cancel_request(self, _: type) -> Any:
        """The oldest, or (None, None)."""
        return self.readers[1].pop() or (None, None)

    def take_result_request(self, _: type) -> Any:
        """The oldest, or (None, None)."""
        return self.readers[2].pop() or (None, None)

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
        """Have a wait set look at our readers."""
        wait_set.add_readers(self.readers)

    def is_ready(self, _: Any) -> tuple[bool, ...]:
        """Whether there is a goal, a cancel request, a result request, an expired goal."""
        has_expired = endpoints.NOW_NS() > self._first_expiry_ns
        return (*(bool(reader.items) for reader in self.readers), has_expired)
