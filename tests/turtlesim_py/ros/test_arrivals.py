"""A node that is polled only when something has arrived misses nothing."""

import pytest
from rclpy.action import ActionServer
from std_srvs.srv import Empty
from turtlesim.action import RotateAbsolute

from tests.graph import wait_for_arrival
from tests.turtlesim_py.ros.test_executor import Served, send, served
from turtlesim_py.ros.executor import QUIET_SPINS, Arrivals

__all__ = ["served"]


class Watched(Served):
    """A node that is polled on arrivals, and counts how often it is."""

    def __init__(self, graph):
        super().__init__(graph)
        self.polls = 0
        polled = self.executor._polled

        def counted(*arguments):
            self.polls += 1
            return polled(*arguments)

        self.executor._polled = counted
        self.executor.rely_on_arrivals()

    def next(self):
        """What the next spin brings that brings anything."""
        return self.graph.until(self.spin, "something to serve")


@pytest.fixture
def watched(graph):
    watched = Watched(graph)
    yield watched
    watched.node.destroy_node()


def test_only_every_sixteenth_spin_polls_where_nothing_arrives(watched):
    watched.service("service")
    for _ in range(3 * QUIET_SPINS):
        watched.spin()
    assert watched.polls == 3


def test_a_burst_is_taken_one_a_spin(watched):
    subscription, publisher = watched.subscription("topic")
    watched.spin()
    send(publisher, 1)
    wait_for_arrival(subscription)
    send(publisher, 2, 3)
    assert [watched.next() for _ in range(3)] == [["topic 1"], ["topic 2"], ["topic 3"]]


def test_what_has_arrived_before_it_is_watched_counts(watched):
    service = watched.service("service")
    watched.graph.ask(Empty, "served/service")
    wait_for_arrival(service)
    assert watched.spin() == ["service"]


def test_messages_requests_and_goals_are_told(served):
    subscription, publisher = served.subscription("topic")
    service = served.service("service")
    server = ActionServer(
        served.node, RotateAbsolute, "served/rotate", lambda _: RotateAbsolute.Result()
    )
    arrivals = Arrivals()
    assert arrivals.watch([subscription], [service], [server])
    assert not arrivals.take()
    send(publisher, 1)
    served.graph.until(arrivals.take, "a message")
    served.graph.ask(Empty, "served/service")
    served.graph.until(arrivals.take, "a request")
    served.graph.action(RotateAbsolute, "served/rotate").send_goal_async(RotateAbsolute.Goal())
    served.graph.until(arrivals.take, "a goal")
    server.destroy()


def test_where_arrivals_cannot_be_told_every_spin_polls(watched, monkeypatch):
    monkeypatch.setattr(Arrivals, "watch", lambda *_: False)
    for _ in range(QUIET_SPINS):
        watched.spin()
    assert watched.polls == QUIET_SPINS
