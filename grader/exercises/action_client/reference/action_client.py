"""Send a goal, follow it, log what comes."""

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.node import Node


class FibonacciClient(Node):
    """Sends the action fibonacci a goal."""

    def __init__(self):
        super().__init__("fibonacci_action_client")
        self.client = ActionClient(self, Fibonacci, "fibonacci")

    def send(self, order: int):
        """Send a goal and return its handle."""
        self.client.wait_for_server()
        goal = Fibonacci.Goal(order=order)
        future = self.client.send_goal_async(goal, feedback_callback=self.follow)
        rclpy.spin_until_future_complete(self, future)
        return future.result()

    def follow(self, message):
        """Log a feedback."""
        self.get_logger().info(f"Received feedback: {list(message.feedback.sequence)}")


def main(args=None):
    """Send a goal, log its result, end."""
    rclpy.init(args=args)
    node = FibonacciClient()
    future = node.send(10).get_result_async()
    rclpy.spin_until_future_complete(node, future)
    node.get_logger().info(f"Result: {list(future.result().result.sequence)}")
    rclpy.shutdown()


if __name__ == "__main__":
    main()
