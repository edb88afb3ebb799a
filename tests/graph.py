"""The other side of a ROS graph: subscribers, publishers and clients for tests."""

import time
from collections.abc import Callable
from typing import Any, TypeVar

import rclpy
from rcl_interfaces.msg import Log
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy
from rclpy.publisher import Publisher
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.service import Service
from rclpy.subscription import Subscription
from rclpy.task import Future

from tests.programs import last_lines

#: Only a failing test waits so long [s].
DEADLINE_S = 90.0
#: An answer that has not come by then is lost: its server had not met who asked [s].
LOST_S = 3.0
#: Deep enough that nothing is lost between two looks.
DEEP = QoSProfile(depth=1000)
#: As nodes publish their logs: late listeners get the old lines too.
ROSOUT_QOS = QoSProfile(depth=1000, durability=DurabilityPolicy.TRANSIENT_LOCAL)

Found = TypeVar("Found")


class Graph:
    """A node that talks with the programs under test; every wait is one for an event."""

    def __init__(self, name: str = "tester") -> None:
        self.node = rclpy.create_node(name, use_global_arguments=False)
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self.node)
        self._clients: dict[str, Any] = {}
        self._actions: list[ActionClient] = []

    def close(self) -> None:
        self._executor.shutdown()
        self.node.destroy_node()

    def forget(self) -> None:
        """Destroy all publishers, subscriptions and clients."""
        node = self.node
        for client in self._actions:
            client.destroy()
        self._actions.clear()
        self._clients.clear()
        for subscription in list(node.subscriptions):
            node.destroy_subscription(subscription)
        for service_client in list(node.clients):
            node.destroy_client(service_client)
        for publisher in list(node.publishers):
            if publisher.topic != "/parameter_events":
                node.destroy_publisher(publisher)

    def until(self, condition: Callable[[], Found], what: str) -> Found:
        """Spin until `condition` returns something true; return that."""
        deadline = time.monotonic() + DEADLINE_S
        while not (found := condition()):
            assert time.monotonic() < deadline, f"waited {DEADLINE_S} s for {what}\n{last_lines()}"
            self._executor.spin_once(timeout_sec=0.02)
        return found

    def done(self, future: Future, what: str = "an answer") -> Any:
        self.until(future.done, what)
        return future.result()

    def answered(self, ask: Callable[[], Future], what: str = "an answer") -> Any:
        """Ask, and again where the answer was lost; what was answered first."""
        asked = [(time.monotonic(), ask())]

        def answer() -> Future | None:
            if time.monotonic() > asked[-1][0] + LOST_S:
                asked.append((time.monotonic(), ask()))
            return next((future for _, future in asked if future.done()), None)

        return self.until(answer, what).result()

    def meet(self, logger: str) -> None:
        """Wait until a node that has just been started has heard of us, and we of it.

        DDS finds each direction on its own. A server that has not heard of its client yet drops
        its answer, so no service is to be called before. The sign is an old line of the node's
        log, which it sends again to whom it finds.
        """
        logs = self.listen(Log, "/rosout", ROSOUT_QOS)
        self.until(lambda: logger in {log.name for log in logs}, f"a line of {logger}")

    def listen(self, kind: type, topic: str, qos: QoSProfile = DEEP) -> list[Any]:
        """Subscribe; messages appear in the list. Returns when a publisher is connected."""
        messages: list[Any] = []
        subscription = self.node.create_subscription(kind, topic, messages.append, qos)
        self.until(subscription.get_publisher_count, f"a publisher on {topic}")
        return messages

    def publisher(self, kind: type, topic: str, qos: QoSProfile = DEEP) -> Publisher:
        """Return a publisher to which a subscriber is connected."""
        publisher = self.node.create_publisher(kind, topic, qos)
        self.until(publisher.get_subscription_count, f"a subscriber on {topic}")
        return publisher

    def ask(self, kind: Any, name: str, /, **fields: Any) -> Future:
        """Send a request; the future of its response."""
        if name not in self._clients:
            self._clients[name] = self.node.create_client(kind, name)
        client = self._clients[name]
        self.until(client.service_is_ready, f"the service {name}")
        future: Future = client.call_async(kind.Request(**fields))
        return future

    def call(self, kind: Any, name: str, /, **fields: Any) -> Any:
        """Call a service; its response."""
        return self.answered(lambda: self.ask(kind, name, **fields), f"a response of {name}")

    def action(self, kind: Any, name: str) -> ActionClient:
        """Return an action client that has found its server."""
        client = ActionClient(self.node, kind, name, feedback_sub_qos_profile=DEEP)
        self._actions.append(client)
        self.until(client.server_is_ready, f"the action {name}")
        return client


def wait_for_arrival(entity: Any) -> None:
    """Wait until a subscription, service or action server has something to take; leave it there.

    For nodes in this process that nobody spins at the moment.
    """
    wait_set = _rclpy.WaitSet(1, 0, 1, 0, 3, 0, rclpy.get_default_context().handle)
    wait_set.clear_entities()
    if isinstance(entity, Subscription):
        wait_set.add_subscription(entity.handle)
    elif isinstance(entity, Service):
        wait_set.add_service(entity.handle)
    else:
        entity.add_to_wait_set(wait_set)
    wait_set.wait(int(DEADLINE_S * 1e9))
    kinds = ("subscription", "service")
    assert any(wait_set.get_ready_entities(kind) for kind in kinds), "nothing has arrived"
