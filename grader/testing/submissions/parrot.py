"""A parrot: a program that sends what was recorded, at the same times, and hears nothing.

`grader.testing.parrot` writes it, with `RECORDED` above it, in place of a right solution's
program. Its servers answer in the recorded order whatever they are asked.
"""

from __future__ import annotations

import importlib
import sys
import time
from functools import partial
from typing import Any

import rclpy
from rclpy.action import ActionClient, ActionServer, CancelResponse, GoalResponse
from rclpy.executors import SingleThreadedExecutor
from rclpy.logging import get_logger
from rclpy.node import Node
from rclpy.qos import QoSProfile
from rclpy.serialization import deserialize_message

RECORDED: dict[str, Any] = {}


def kind_of(name: str) -> Any:
    package, kind, last = name.split("/")
    return getattr(importlib.import_module(f"{package}.{kind}"), last)


def filled(message: Any, values: dict[str, Any]) -> Any:
    for name, value in values.items():
        if isinstance(value, dict):
            filled(getattr(message, name), value)
        else:
            setattr(message, name, value)
    return message


class Parrot(Node):
    """A node with its endpoints.

    Attributes:
        due: what it does by itself: when [s], and what.
    """

    def __init__(self, name: str, namespace: str, facts: dict[str, Any]) -> None:
        super().__init__(name, namespace=namespace)
        self.due: list[tuple[float, Any]] = []
        for parameter, value in facts["parameters"].items():
            if not self.has_parameter(parameter):
                self.declare_parameter(parameter, value)
        for topic, (kind, *quality), messages in facts["topics"]:
            self._say(topic, kind_of(kind), quality, messages)
        for time_s, level, text in facts["logs"]:
            # of its own: from one line a logger logs at one level only
            logger = get_logger(self.get_logger().name)
            self.due.append((time_s, partial(logger.log, text, level)))
        for service, kind, responses in facts["services"]:
            self._serve(service, kind_of(kind), iter(responses))
        for service, kind, requests in facts["calls"]:
            client = self.create_client(kind_of(kind), service)
            for time_s, values in requests:
                request = filled(client.srv_type.Request(), values)
                self.due.append((time_s, partial(client.call_async, request)))
        for action, kind, goals in facts["actions"]:
            self._act(action, kind_of(kind), iter(goals))
        for action, kind, goals in facts["goals"]:
            sender = ActionClient(self, kind_of(kind), action)
            for time_s, values in goals:
                goal = filled(sender._action_type.Goal(), values)
                self.due.append((time_s, partial(sender.send_goal_async, goal)))

    def _say(self, topic: str, kind: Any, quality: list[int], messages: list[Any]) -> None:
        reliability, durability, depth = quality
        profile = QoSProfile(depth=depth, reliability=reliability, durability=durability)
        publisher = self.create_publisher(kind, topic, profile)
        for time_s, data in messages:
            message = deserialize_message(bytes.fromhex(data), kind)
            self.due.append((time_s, partial(publisher.publish, message)))

    def _serve(self, service: str, kind: Any, responses: Any) -> None:
        def answer(_: Any, response: Any) -> Any:
            return filled(response, next(responses, {}))

        self.create_service(kind, service, answer)

    def _act(self, action: str, kind: Any, goals: Any) -> None:
        told: list[Any] = []

        def judged(_: Any) -> Any:
            told.append(next(goals, None))
            accepted = told[-1] is not None and told[-1]["accepted"]
            return GoalResponse.ACCEPT if accepted else GoalResponse.REJECT

        async def execute(handle: Any) -> Any:
            goal = told[-1]
            for values in goal["feedback"]:
                handle.publish_feedback(filled(kind.Feedback(), values))
            ends = {"succeeded": handle.succeed, "canceled": handle.abort}
            ends.get(goal["status"], handle.abort)()
            return filled(kind.Result(), goal["result"])

        more = {"goal_callback": judged, "cancel_callback": lambda _: CancelResponse.ACCEPT}
        self._server = ActionServer(self, kind, action, execute, **more)


def main(args: Any = None) -> None:
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    nodes = [Parrot(*node) for node in RECORDED["nodes"]]
    for node in nodes:
        executor.add_node(node)
    begin_s = time.monotonic()
    due = sorted((each for node in nodes for each in node.due), key=lambda each: each[0])
    for time_s, do in due:
        while (left_s := begin_s + time_s - time.monotonic()) > 0:
            executor.spin_once(timeout_sec=left_s)
        do()
    if RECORDED["ends"]:
        executor.spin_once(timeout_sec=0.1)
        rclpy.shutdown()
        sys.exit(RECORDED["exit_code"])
    executor.spin()
