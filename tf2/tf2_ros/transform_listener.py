"""`TransformListener`: puts the transforms of /tf and /tf_static into a buffer."""

from __future__ import annotations

from contextlib import suppress
from threading import Thread
from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

DEFAULT_TF_TOPIC = "/tf"
DEFAULT_STATIC_TF_TOPIC = "/tf_static"
#: Who has sent a message is not known to its receiver.
AUTHORITY = "default_authority"


class TransformListener:
    """Listens for transforms while its node spins.

    Args:
        buffer: gets what is heard.
        node: what listens.
        spin_thread: spin the node in a separate thread.
        qos, static_qos: a quality of service, or the depth of one.
        tf_topic, tf_static_topic: where to listen.
    """

    def __init__(
        self, buffer: Any, node: Node, *, spin_thread: bool = False,
        qos: QoSProfile | int | None = None, static_qos: QoSProfile | int | None = None,
        tf_topic: str = DEFAULT_TF_TOPIC, tf_static_topic: str = DEFAULT_STATIC_TF_TOPIC,
    ) -> None:  # fmt: skip
        self.buffer = buffer
        self.node = node
        # so that transforms come in while a callback of the node waits for one
        self.group = ReentrantCallbackGroup()
        self.tf_sub = self._listen(tf_topic, self.callback, qos, DurabilityPolicy.VOLATILE)
        self.tf_static_sub = self._listen(
            tf_static_topic, self.static_callback, static_qos, DurabilityPolicy.TRANSIENT_LOCAL
        )
        if spin_thread:
            self.executor = SingleThreadedExecutor()
            self.dedicated_listener_thread = Thread(target=self._spin)
            self.dedicated_listener_thread.start()

    def _listen(
        self, topic: str, callback: Any, qos: QoSProfile | int | None, durability: DurabilityPolicy
    ) -> Any:
        if qos is None:
            qos = QoSProfile(depth=100, durability=durability, history=HistoryPolicy.KEEP_LAST)
        return self.node.create_subscription(
            TFMessage, topic, callback, qos, callback_group=self.group
        )

    def _spin(self) -> None:
        self.executor.add_node(self.node)
        with suppress(ExternalShutdownException):
            self.executor.spin()
        self.executor.remove_node(self.node)

    def __del__(self) -> None:
        if hasattr(self, "dedicated_listener_thread"):
            self.executor.shutdown()
            self.dedicated_listener_thread.join()
        self.unregister()

    def unregister(self) -> None:
        """Stop listening."""
        for subscription in ("tf_sub", "tf_static_sub"):
            if hasattr(self, subscription):
                self.node.destroy_subscription(getattr(self, subscription))

    def callback(self, data: TFMessage) -> None:
        """Store transforms of moving frames."""
        for transform in data.transforms:
            self.buffer.set_transform(transform, AUTHORITY)

    def static_callback(self, data: TFMessage) -> None:
        """Store transforms of static frames."""
        for transform in data.transforms:
            self.buffer.set_transform_static(transform, AUTHORITY)
