import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__("minimal_publisher")
        group = ReentrantCallbackGroup()
        self.numbers = iter(range(1_000_000))
        self.publisher = self.create_publisher(String, "/topic", 10, callback_group=group)
        self.timer = self.create_timer(0.5, self.talk, callback_group=group)

    def talk(self):
        msg = String(data="Hello World: " + str(next(self.numbers)))
        self.get_logger().info('Publishing: "' + msg.data + '"')
        self.publisher.publish(msg)


def main(args=None):
    rclpy.init(args=args)
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(Talker())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
