import sys

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class Client(Node):
    def __init__(self, a, b):
        super().__init__("client")
        self.client = self.create_client(AddTwoInts, "add_two_ints")
        self.request = AddTwoInts.Request(a=a, b=b)
        self.timer = self.create_timer(0.2, self.ask)

    def ask(self):
        if not self.client.service_is_ready():
            return
        self.timer.cancel()
        self.client.call_async(self.request).add_done_callback(self.on_answer)

    def on_answer(self, future):
        self.get_logger().info(
            "Result of add_two_ints: for {} + {} = {}".format(
                self.request.a, self.request.b, future.result().sum
            )
        )
        raise SystemExit


def main():
    rclpy.init()
    node = Client(int(sys.argv[1]), int(sys.argv[2]))
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException, SystemExit):
        pass
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
