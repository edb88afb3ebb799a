import rclpy
from action_tutorials_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.node import Node


class FibonacciClient(Node):
    def __init__(self):
        super().__init__('fibonacci_client')
        self.client = ActionClient(self, Fibonacci, 'fibonacci')

    def run(self, order):
        self.client.wait_for_server()
        sent = self.client.send_goal_async(Fibonacci.Goal(order=order), self.on_feedback)
        rclpy.spin_until_future_complete(self, sent)
        done = sent.result().get_result_async()
        rclpy.spin_until_future_complete(self, done)
        self.get_logger().info(f'Result: {done.result().result.sequence}')

    def on_feedback(self, message):
        self.get_logger().info(f'Received feedback: {message.feedback.partial_sequence}')


def main(args=None):
    rclpy.init(args=args)
    node = FibonacciClient()
    node.run(10)
    node.destroy_node()
    rclpy.shutdown()
