"""What one spin of a node takes, and in which order."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from geometry_msgs.msg import Twist, Vector3
from rclpy.node import Node
from rclpy.service import Service
from rclpy.subscription import Subscription
from std_srvs.srv import Empty, Trigger

from tests.graph import Graph, wait_for_arrival
from turtlesim_py.ros.executor import OnFailure, TickExecutor


class Served:
    """A node that notes what it is served."""

    def __init__(self, graph: Graph, on_failure: OnFailure | None = None) -> None:
        self.graph = graph
        self.node = Node("served", use_global_arguments=False)
        self.notes: list[str] = []
        self.executor = TickExecutor(self.node, on_failure)

    def subscription(self, name: str) -> tuple[Subscription, Any]:
        """A subscription that notes x, and a publisher for it."""

        def on_message(message: Twist) -> None:
            self.notes.append(f"{name} {message.linear.x:g}")

        topic = f"served/{name}"
        subscription = self.node.create_subscription(Twist, topic, on_message, 7)
        return subscription, self.graph.publisher(Twist, topic)

    def service(self, name: str, then: Any = lambda: None) -> Service:
        def on_request(_: Any, response: Any) -> Any:
            self.notes.append(name)
            then()
            return response

        return self.node.create_service(Empty, f"served/{name}", on_request)

    def spin(self) -> list[str]:
        """What one spin brings."""
        self.notes.clear()
        self.executor.spin_some()
        return list(self.notes)


@pytest.fixture
def served(graph: Graph) -> Iterator[Served]:
    served = Served(graph)
    yield served
    served.node.destroy_node()


def send(publisher: Any, *numbers: float) -> None:
    for number in numbers:
        publisher.publish(Twist(linear=Vector3(x=float(number))))


def test_a_spin_takes_one_message_of_each_subscription(served: Served) -> None:
    first, to_first = served.subscription("first")
    second, to_second = served.subscription("second")
    send(to_first, 1, 2, 3)
    send(to_second, 4)
    wait_for_arrival(first)
    wait_for_arrival(second)
    assert served.spin() == ["first 1", "second 4"]
    served.graph.until(lambda: served.spin() == ["first 2"], "the second message")
    served.graph.until(lambda: served.spin() == ["first 3"], "the third message")
    assert served.spin() == []


def test_a_spin_takes_one_request_of_each_service(served: Served) -> None:
    service = served.service("service")
    asked = [served.graph.ask(Empty, "served/service") for _ in range(2)]
    wait_for_arrival(service)
    assert served.spin() == ["service"]
    served.graph.until(lambda: served.spin() == ["service"], "the second request")
    served.graph.until(lambda: all(future.done() for future in asked), "the answers")


def test_subscriptions_come_before_services(served: Served) -> None:
    service = served.service("service")
    subscription, publisher = served.subscription("topic")
    served.graph.ask(Empty, "served/service")
    wait_for_arrival(service)
    send(publisher, 1)
    wait_for_arrival(subscription)
    assert served.spin() == ["topic 1", "service"]


def test_what_a_callback_creates_or_destroys_is_respected_at_once(served: Served) -> None:
    doomed: list[Service] = []

    def destroy() -> None:
        served.node.destroy_service(doomed.pop())
        served.service("new")

    first = served.service("first", then=destroy)
    doomed.append(served.service("doomed"))
    served.graph.ask(Empty, "served/first")
    served.graph.ask(Empty, "served/doomed")
    wait_for_arrival(first)
    wait_for_arrival(doomed[0])
    assert served.spin() == ["first"]
    served.graph.ask(Empty, "served/new")
    served.graph.until(lambda: served.spin() == ["new"], "the new service")


def test_an_exception_of_a_callback_reaches_the_caller(served: Served) -> None:
    def fail() -> None:
        raise ZeroDivisionError

    service = served.service("failing", then=fail)
    served.graph.ask(Empty, "served/failing")
    wait_for_arrival(service)
    with pytest.raises(ZeroDivisionError):
        served.executor.spin_some()


def test_where_somebody_wants_to_be_told_an_exception_hinders_nothing(graph: Graph) -> None:
    def fail() -> None:
        raise ZeroDivisionError("no")

    told: list[str] = []
    served = Served(graph, lambda what, error: told.append(f"{what}: {error}"))
    failing, other = served.service("failing", then=fail), served.service("other")
    answer = graph.ask(Empty, "served/failing")
    graph.ask(Empty, "served/other")
    wait_for_arrival(failing)
    wait_for_arrival(other)
    assert served.spin() == ["failing", "other"]
    assert told == ["served/failing: no"]
    graph.done(answer)  # an empty one is better than none
    served.node.destroy_node()


def test_what_it_does_not_serve_is_not_left_waiting_silently(served: Served) -> None:
    served.node.create_client(Trigger, "somewhere")
    with pytest.raises(AssertionError, match="not served"):
        served.executor.spin_some()
