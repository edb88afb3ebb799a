"""Sleeps by a rate, in an executor with several threads."""

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


class FibonacciServer(Node):
    def __init__(self):
        super().__init__("fibonacci_server")
        self.rate = self.create_rate(4)
        self.server = ActionServer(
            self, Fibonacci, "fibonacci", self.execute, callback_group=ReentrantCallbackGroup()
        )

    def execute(self, handle):
        seq = [0, 1]
        for i in range(2, handle.request.order + 1):
            seq.append(seq[i - 1] + seq[i - 2])
            msg = Fibonacci.Feedback()
            msg.sequence = seq
            handle.publish_feedback(msg)
            self.rate.sleep()
        handle.succeed()
        result = Fibonacci.Result()
        result.sequence = seq
        return result


def main():
    rclpy.init()
    node = FibonacciServer()
    try:
        rclpy.spin(node, MultiThreadedExecutor(num_threads=4))
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
