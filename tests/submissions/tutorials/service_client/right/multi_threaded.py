import argparse

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.task import Future


class Client(Node):
    def __init__(self, a, b):
        super().__init__("client")
        self.a, self.b = a, b
        self.done = Future()
        self.client = self.create_client(
            AddTwoInts, "add_two_ints", callback_group=MutuallyExclusiveCallbackGroup()
        )
        self.timer = self.create_timer(
            0.1, self.ask, callback_group=MutuallyExclusiveCallbackGroup()
        )

    def ask(self):
        self.timer.cancel()
        self.client.wait_for_service()
        total = self.client.call(AddTwoInts.Request(a=self.a, b=self.b)).sum
        self.get_logger().info(f"Result of add_two_ints: for {self.a} + {self.b} = {total}")
        self.done.set_result(total)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("a", type=int)
    parser.add_argument("b", type=int)
    numbers, _ = parser.parse_known_args()
    rclpy.init()
    node = Client(numbers.a, numbers.b)
    executor = MultiThreadedExecutor(num_threads=3)
    rclpy.spin_until_future_complete(node, node.done, executor)
    executor.shutdown()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
