"""The two nodes, and how to start them: each alone or both in one process."""

import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

QOS = QoSProfile(depth=5, reliability=ReliabilityPolicy.RELIABLE)


class MinimalPublisher(Node):
    """Says hello twice a second."""

    def __init__(self) -> None:
        super().__init__("minimal_publisher")
        self._pub = self.create_publisher(String, "topic", QOS)
        self._i = -1
        self.create_timer(0.5, self._on_timer, callback_group=ReentrantCallbackGroup())

    async def _on_timer(self) -> None:
        self._i += 1
        msg = String(data=f"Hello World: {self._i}")
        self._pub.publish(msg)
        self.get_logger().info(f'Publishing: "{msg.data}"')


class MinimalSubscriber(Node):
    """Logs what is said."""

    def __init__(self) -> None:
        super().__init__("minimal_subscriber")
        self.create_subscription(String, "topic", self._on_message, QOS)

    def _on_message(self, msg: String) -> None:
        self.get_logger().info(f'I heard: "{msg.data}"')


def _run(*classes) -> None:
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=2)
    for node_class in classes:
        executor.add_node(node_class())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


def run_publisher():
    _run(MinimalPublisher)


def run_subscriber():
    _run(MinimalSubscriber)


def run_both():
    _run(MinimalPublisher, MinimalSubscriber)
