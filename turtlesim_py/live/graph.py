"""The ROS graph for viewers of the page: a node that publishes and calls for them.

The simulator's node serves only the turtles. Messages and calls of viewers go over the graph like
those of any program, so that `ros2 topic echo` shows them as well. The node's name begins with an
underscore: `ros2 node list` leaves it out.
"""

from __future__ import annotations

import asyncio
import os
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any, Final

import rclpy
from rclpy.action import ActionClient
from rclpy.exceptions import InvalidServiceNameException, InvalidTopicNameException
from rclpy.executors import SingleThreadedExecutor, TimeoutException
from rclpy.node import Node
from rclpy.publisher import Publisher
from rclpy.qos import QoSProfile, qos_profile_best_available
from rclpy.subscription import Subscription

from turtlesim_py.live import messages
from turtlesim_py.live.messages import Rejected

#: Gets the content of a message.
OnMessage = Callable[[Mapping[str, Any]], None]
#: As every publisher of turtlesim.
PUBLISHER_QOS: Final = QoSProfile(depth=10)
#: A missing service is reported after this time [s].
PATIENCE_S: Final = 2.0
#: Between two polls [s]: 50 times a second, as often as a page is drawn. Each serves so many
#: messages at most: a flood of them is dropped by the middleware, and does not starve viewers.
_PAUSE_S: Final = 0.02
_MOST_AT_ONCE: Final = 50


class Graph:
    """A node of ROS, polled by the asyncio loop that it is made in: all of it is for one thread."""

    def __init__(self) -> None:
        self.node = Node(
            f"_turtlesim_live_{os.getpid()}",
            use_global_arguments=False,  # a name that the simulator was given is not this one's
            enable_rosout=False,
            start_parameter_services=False,
        )
        self._executor = SingleThreadedExecutor()
        self._executor.add_node(self.node)
        self._clients: dict[tuple[str, str], Any] = {}
        self._polling = asyncio.get_running_loop().create_task(self._poll())

    async def _poll(self) -> None:
        while rclpy.ok():
            try:
                for _ in range(_MOST_AT_ONCE):
                    serve, *_ = self._executor.wait_for_ready_callbacks(timeout_sec=0)
                    serve()
            except TimeoutException:  # nothing more is ready
                pass
            await asyncio.sleep(_PAUSE_S)

    def close(self) -> None:
        self._polling.cancel()
        self._executor.shutdown()
        if rclpy.ok():
            self.node.destroy_node()

    # Topics -----------------------------------------------------------------------------------

    def subscribe(self, topic: str, type_name: str, on_message: OnMessage) -> Subscription:
        """Subscribe to a topic; '' as type means the type that it has.

        Raises:
            Rejected: there is no such topic, or no such type.
        """
        kind = messages.find(type_name or self.topic_type(topic), "msg")
        return _made(
            self.node.create_subscription,
            kind,
            topic,
            lambda message: on_message(messages.to_json(message)),
            qos_profile_best_available,
        )

    def advertise(self, topic: str, type_name: str) -> Publisher:
        """Return a publisher; '' as type means the type that the topic has.

        Raises:
            Rejected: there is no such topic, or no such type.
        """
        kind = messages.find(type_name or self.topic_type(topic), "msg")
        return _made(self.node.create_publisher, kind, topic, PUBLISHER_QOS)

    # Services and actions ---------------------------------------------------------------------

    async def call(self, service: str, type_name: str, args: object) -> dict[str, Any]:
        """Call a service and return its answer; '' as type means the type that it has.

        Raises:
            Rejected: it cannot be called so.
        """
        type_name = type_name or self.service_type(service)
        kind = messages.find(type_name, "srv")
        request = messages.from_json(kind.Request, args)
        client = self._client(self.node.create_client, kind, service, type_name)
        await _until(client.service_is_ready, Rejected("nobody serves {service}", service=service))
        future = client.call_async(request)
        try:
            return messages.to_json(await _result(future))
        except asyncio.CancelledError:
            client.remove_pending_request(future)
            raise

    async def send_goal(
        self,
        action: str,
        type_name: str,
        args: object,
        on_feedback: OnMessage,
        is_cancelled: Callable[[], bool],
    ) -> tuple[dict[str, Any], int]:
        """Send a goal and wait for its end, which it is asked for when `is_cancelled`.

        Returns:
            The result, and the status as action_msgs/msg/GoalStatus has it.

        Raises:
            Rejected: it cannot be sent so, or it was not accepted.
        """
        kind = messages.find(type_name, "action")
        goal = messages.from_json(kind.Goal, args)
        client = self._client(partial(ActionClient, self.node), kind, action, type_name)
        await _until(
            client.server_is_ready, Rejected("nobody serves the action {action}", action=action)
        )

        def convert(message: Any) -> None:
            on_feedback(messages.to_json(message.feedback))

        handle = await _result(client.send_goal_async(goal, convert))
        if not handle.accepted:
            raise Rejected("the goal for {action} was not accepted", action=action)
        ended = handle.get_result_async()
        while not (ended.done() or is_cancelled()):
            await asyncio.sleep(_PAUSE_S)
        if not ended.done():
            handle.cancel_goal_async()
        answer = await _result(ended)
        return messages.to_json(answer.result), answer.status

    def _client(self, create: Callable[..., Any], kind: Any, name: str, type_name: str) -> Any:
        """Return the client of a service or an action, made at its first use."""
        if (name, type_name) not in self._clients:
            self._clients[name, type_name] = _made(create, kind, name)
        return self._clients[name, type_name]

    # What there is ----------------------------------------------------------------------------

    def topics(self) -> dict[str, str]:
        """Topic -> its type, or the first of them; none of those that are hidden."""
        return _shown(self.node.get_topic_names_and_types())

    def services(self) -> dict[str, str]:
        return _shown(self.node.get_service_names_and_types())

    def publishers(self, topic: str) -> list[str]:
        """Return the full names of the nodes that publish on a topic."""
        return _names(self.node.get_publishers_info_by_topic(topic))

    def subscribers(self, topic: str) -> list[str]:
        """Return the full names of the nodes that subscribe to a topic."""
        return _names(self.node.get_subscriptions_info_by_topic(topic))

    def topic_type(self, topic: str) -> str:
        """Return the type of a topic; Rejected where there is no such topic."""
        missing = Rejected("there is no topic {name}", name=f"{topic!r:.80}")
        return _type(topic, self.node.get_topic_names_and_types(), missing)

    def service_type(self, service: str) -> str:
        """Return the type of a service; Rejected where there is no such service."""
        missing = Rejected("there is no service {name}", name=f"{service!r:.80}")
        return _type(service, self.node.get_service_names_and_types(), missing)


def _made(create: Callable[..., Any], *arguments: Any) -> Any:
    try:
        return create(*arguments)
    except (InvalidTopicNameException, InvalidServiceNameException) as error:
        raise Rejected("ROS: {error}", error=str(error).replace("\n", " ")) from None


def _type(name: str, there: list[tuple[str, list[str]]], missing: Rejected) -> str:
    types = dict(there).get(name if name.startswith("/") else f"/{name}")
    if not types:
        raise missing
    return types[0]


def _shown(there: list[tuple[str, list[str]]]) -> dict[str, str]:
    return {name: types[0] for name, types in sorted(there) if types and "/_" not in name}


def _names(endpoints: list[Any]) -> list[str]:
    """Return the names of the endpoints' nodes, without those of viewers."""
    full = {f"{each.node_namespace.rstrip('/')}/{each.node_name}" for each in endpoints}
    return sorted(name for name in full if "/_" not in name)


async def _until(is_ready: Callable[[], bool], otherwise: Rejected) -> None:
    """Wait until a server is ready; its discovery takes some time."""
    for _ in range(round(PATIENCE_S / _PAUSE_S)):
        if is_ready():
            return
        await asyncio.sleep(_PAUSE_S)
    raise otherwise


async def _result(future: Any) -> Any:
    """Wait for the result of an rclpy future."""
    while not future.done():
        await asyncio.sleep(_PAUSE_S)
    if (error := future.exception()) is not None:
        raise Rejected("ROS: {error}", error=error)
    return future.result()
