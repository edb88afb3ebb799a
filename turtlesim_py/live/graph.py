"""The ROS graph for whoever comes through the page: a node of its own, in a thread of its own.

The simulator's node serves the turtles and nobody else; what viewers publish and call goes the way
that every program's messages go, so that `ros2 topic echo` shows it as well. The node's name begins
with an underscore: `ros2 node list` leaves it out.
"""

from __future__ import annotations

import asyncio
import os
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any, Final

import rclpy
from rclpy.action import ActionClient
from rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, qos_profile_best_available
from rclpy.subscription import Subscription

from turtlesim_py.live import messages
from turtlesim_py.live.messages import NotThere

#: Gets what a message says; called in the graph's thread.
Hear = Callable[[Mapping[str, Any]], None]
#: As every publisher of turtlesim.
PUBLISHER_QOS: Final = QoSProfile(depth=10)
#: A service that nobody serves is told after this [s]; so often is looked for it.
PATIENCE_S: Final = 2.0
_PAUSE_S: Final = 0.02

_BAD_NAMES = (InvalidTopicNameException, InvalidServiceNameException)


class Graph:
    """A node of ROS that does what viewers ask for.

    Methods are for the thread of an asyncio loop. What the node has is made and destroyed in its
    own thread alone: rclpy's executor goes through all of it at any time.
    """

    def __init__(self) -> None:
        self.node = Node(
            f"_turtlesim_live_{os.getpid()}",
            use_global_arguments=False,  # a name that the simulator was given is not this one's
            enable_rosout=False,
            start_parameter_services=False,
        )
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self.node)
        self._is_closed = False
        self._clients: dict[tuple[str, str], Any] = {}
        self._actions: dict[tuple[str, str], ActionClient] = {}
        self._thread = threading.Thread(target=self._spin, name="live graph", daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        with suppress(ExternalShutdownException):
            while rclpy.ok() and not self._is_closed:
                self._executor.spin_once()

    def close(self) -> None:
        """Leave the graph, when what the thread is at has come to its end.

        rclpy's shutdown takes from an executor what a callback in another thread still works with.
        """

        def end() -> None:
            self._is_closed = True

        self._executor.create_task(end)
        self._thread.join(1.0)
        if self._thread.is_alive():
            return
        self._executor.shutdown(timeout_sec=1.0)
        if rclpy.ok():
            self.node.destroy_node()

    async def _do(self, work: Callable[[], Any]) -> Any:
        """What `work` returns, or raises, in the graph's thread."""

        def kept() -> tuple[Any, Exception | None]:
            try:
                return work(), None
            except Exception as error:  # one that came through would end the thread
                return None, error

        made, error = await _result(self._executor.create_task(kept))
        if isinstance(error, _BAD_NAMES):
            raise NotThere(str(error).replace("\n", " "))
        if error is not None:
            raise error
        return made

    # Topics -----------------------------------------------------------------------------------

    async def subscribe(self, topic: str, type_name: str, hear: Hear) -> Subscription:
        """Hear a topic; '' as type takes the one that it has.

        Raises:
            NotThere, NoSuchType: there is no such topic, or no such type.
        """
        kind = messages.find(type_name or self.topic_type(topic), "msg")
        return await self._do(
            lambda: self.node.create_subscription(
                kind, topic, lambda m: hear(messages.to_json(m)), qos_profile_best_available
            )
        )

    async def advertise(self, topic: str, type_name: str) -> Publisher:
        """A publisher; '' as type takes the one that the topic has.

        Raises:
            NotThere, NoSuchType: there is no such topic, or no such type.
        """
        kind = messages.find(type_name or self.topic_type(topic), "msg")
        return await self._do(lambda: self.node.create_publisher(kind, topic, PUBLISHER_QOS))

    async def forget(self, subscriptions: list[Any], publishers: list[Any]) -> None:
        """Give back what `subscribe` and `advertise` have given."""

        def destroy() -> None:
            for subscription in subscriptions:
                self.node.destroy_subscription(subscription)
            for publisher in publishers:
                self.node.destroy_publisher(publisher)

        await self._do(destroy)

    # Services and actions ---------------------------------------------------------------------

    async def call(self, service: str, type_name: str, args: object) -> dict[str, Any]:
        """Call a service and return what it answers; '' as type takes the one that it has.

        Raises:
            NotThere, NoSuchType, Unfit: it cannot be called so.
        """
        type_name = type_name or self.service_type(service)
        kind = messages.find(type_name, "srv")
        request = messages.from_json(kind.Request, args)
        client = self._clients.get((service, type_name))
        if client is None:
            client = await self._do(lambda: self.node.create_client(kind, service))
            self._clients[service, type_name] = client
        await _until(client.service_is_ready, f"nobody serves {service}")
        future = client.call_async(request)
        try:
            return messages.to_json(await _result(future))
        except asyncio.CancelledError:
            client.remove_pending_request(future)
            raise

    async def send_goal(
        self, action: str, type_name: str, args: object, feedback: Hear
    ) -> tuple[dict[str, Any], int]:
        """Send a goal and wait for its end; whoever cancels the wait cancels the goal.

        Args:
            feedback: called in the graph's thread.

        Returns:
            The result, and the status as action_msgs/msg/GoalStatus has it.

        Raises:
            NotThere, NoSuchType, Unfit: it cannot be sent so, or it was not accepted.
        """
        kind = messages.find(type_name, "action")
        goal = messages.from_json(kind.Goal, args)
        client = self._actions.get((action, type_name))
        if client is None:
            client = await self._do(lambda: ActionClient(self.node, kind, action))
            self._actions[action, type_name] = client
        await _until(client.server_is_ready, f"nobody serves the action {action}")
        handle = await _result(
            client.send_goal_async(goal, lambda m: feedback(messages.to_json(m.feedback)))
        )
        if not handle.accepted:
            raise NotThere(f"the goal for {action} was not accepted")
        ended = handle.get_result_async()
        try:
            answer = await _result(ended)
        except asyncio.CancelledError:
            handle.cancel_goal_async()
            answer = await _result(ended)
        return messages.to_json(answer.result), answer.status

    # What there is ----------------------------------------------------------------------------

    def topics(self) -> dict[str, str]:
        """Topic -> its type, or the first of them; none of those that are hidden."""
        return _shown(self.node.get_topic_names_and_types())

    def services(self) -> dict[str, str]:
        """Service -> its type."""
        return _shown(self.node.get_service_names_and_types())

    def nodes_of(self, topic: str) -> tuple[list[str], list[str]]:
        """The full names of the nodes that publish on a topic, and of those that subscribe."""
        publishers = self.node.get_publishers_info_by_topic(topic)
        subscribers = self.node.get_subscriptions_info_by_topic(topic)
        return _names(publishers), _names(subscribers)

    def topic_type(self, topic: str) -> str:
        """The type of a topic; NotThere where nobody has it."""
        return self._type("topic", topic, self.node.get_topic_names_and_types())

    def service_type(self, service: str) -> str:
        """The type of a service; NotThere where nobody has it."""
        return self._type("service", service, self.node.get_service_names_and_types())

    def _type(self, what: str, name: str, there: list[tuple[str, list[str]]]) -> str:
        types = dict(there).get(name if name.startswith("/") else f"/{name}")
        if not types:
            raise NotThere(f"there is no {what} {name!r:.80}")
        return types[0]


def _shown(there: list[tuple[str, list[str]]]) -> dict[str, str]:
    return {name: types[0] for name, types in sorted(there) if types and "/_" not in name}


def _names(endpoints: list[Any]) -> list[str]:
    """Their nodes, but those of viewers."""
    full = {f"{each.node_namespace.rstrip('/')}/{each.node_name}" for each in endpoints}
    return sorted(name for name in full if "/_" not in name)


async def _until(is_ready: Callable[[], bool], otherwise: str) -> None:
    """Wait until somebody is there; the graph needs some time to find who is."""
    for _ in range(round(PATIENCE_S / _PAUSE_S)):
        if is_ready():
            return
        await asyncio.sleep(_PAUSE_S)
    raise NotThere(otherwise)


async def _result(future: Any) -> Any:
    """What a future of rclpy's, which ends in the graph's thread, will hold."""
    loop = asyncio.get_running_loop()
    ours: asyncio.Future[Any] = loop.create_future()

    def take(made: Any) -> None:
        if not ours.done():  # whoever waited may have given up
            ours.set_result(made)

    future.add_done_callback(lambda made: loop.call_soon_threadsafe(take, made))
    made = await ours
    error = made.exception()
    if error is not None:
        raise NotThere(str(error))
    return made.result()
