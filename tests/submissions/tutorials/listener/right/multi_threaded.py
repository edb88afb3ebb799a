import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import QoSProfile
from std_msgs.msg import String


class Listener(Node):
    def __init__(self) -> None:
        super().__init__("minimal_subscriber")
        self.group = MutuallyExclusiveCallbackGroup()
        self.sub = self.create_subscription(
            String, "topic", self.on_text, QoSProfile(depth=10), callback_group=self.group
        )

    def on_text(self, msg: String) -> None:
        self.get_logger().info(f'I heard: "{msg.data}"')


def main() -> None:
    rclpy.init()
    node = Listener()
    executor = MultiThreadedExecutor()
    try:
        rclpy.spin(node, executor)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
