"""A timer that looks how far things are."""

import rclpy
from action_tutorials_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class Client(Node):
    def __init__(self):
        super().__init__("fibonacci_client")
        self.client = ActionClient(self, Fibonacci, "fibonacci")
        self.state = "waiting"
        self.timer = self.create_timer(0.1, self.step)

    def step(self):
        if self.state == "waiting" and self.client.server_is_ready():
            self.future = self.client.send_goal_async(Fibonacci.Goal(order=10), self.feedback)
            self.state = "asked"
        elif self.state == "asked" and self.future.done():
            self.future = self.future.result().get_result_async()
            self.state = "accepted"
        elif self.state == "accepted" and self.future.done():
            self.get_logger().info("Result: %s" % list(self.future.result().result.sequence))
            self.state = "done"

    def feedback(self, message):
        numbers = list(message.feedback.partial_sequence)
        self.get_logger().info("Received feedback: %s" % numbers)


def main():
    rclpy.init()
    node = Client()
    try:
        while node.state != "done":
            rclpy.spin_once(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    node.destroy_node()
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
