import pytest
from geometry_msgs.msg import Twist, Vector3
from rclpy.node import Node
from std_srvs.srv import Empty, Trigger

from tests.graph import wait_for_arrival
from turtlesim_py.ros.executor import TickExecutor


class Served:
    def __init__(self, graph, on_failure=None):
        self.graph = graph
        self.node = Node("served", use_global_arguments=False)
        self.notes = []
        self.executor = TickExecutor(self.node, on_failure)

    def subscription(self, name):
        """A subscription that notes x, and a publisher for it."""

        def on_message(message):
            self.notes.append(f"{name} {message.linear.x:g}")

        topic = f"served/{name}"
        subscription = self.node.create_subscription(Twist, topic, on_message, 7)
        return subscription, self.graph.publisher(Twist, topic)

    def service(self, name, then=lambda: None):
        def on_request(_, response):
            self.notes.append(name)
            then()
            return response

        return self.node.create_service(Empty, f"served/{name}", on_request)

    def spin(self):
        self.notes.clear()
        self.executor.spin_some()
        return list(self.notes)


@pytest.fixture
def served(graph):
    served = Served(graph)
    yield served
    served.node.destroy_node()


def send(publisher, *numbers):
    for number in numbers:
        publisher.publish(Twist(linear=Vector3(x=float(number))))


def test_a_spin_takes_one_message_of_each_subscription(served):
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


def test_a_spin_takes_one_request_of_each_service_after_the_messages(served):
    service = served.service("service")
    subscription, publisher = served.subscription("topic")
    asked = [served.graph.ask(Empty, "served/service") for _ in range(2)]
    wait_for_arrival(service)
    send(publisher, 1)
    wait_for_arrival(subscription)
    assert served.spin() == ["topic 1", "service"]
    served.graph.until(lambda: served.spin() == ["service"], "the second request")
    served.graph.until(lambda: all(future.done() for future in asked), "the answers")


def test_what_a_callback_creates_or_destroys_is_respected_at_once(served):
    doomed = []

    def destroy():
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


def test_an_exception_reaches_the_caller_or_who_wants_to_be_told_and_hinders_nothing(graph):
    def fail():
        raise ZeroDivisionError("no")

    told = []
    for on_failure in (None, lambda what, error: told.append(f"{what}: {error}")):
        served = Served(graph, on_failure)
        failing, other = served.service("failing", then=fail), served.service("other")
        answer = graph.ask(Empty, "served/failing")
        graph.ask(Empty, "served/other")
        wait_for_arrival(failing)
        wait_for_arrival(other)
        if on_failure is None:
            with pytest.raises(ZeroDivisionError):
                served.executor.spin_some()
        else:
            assert served.spin() == ["failing", "other"]
            graph.done(answer)  # an empty one is better than none
        served.node.destroy_node()
    assert told == ["served/failing: no"]


def test_what_it_does_not_serve_is_not_left_waiting_silently(served):
    served.node.create_client(Trigger, "somewhere")
    with pytest.raises(AssertionError, match="not served"):
        served.executor.spin_some()
