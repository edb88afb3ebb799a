"""The action of example_interfaces, whose feedback has the field sequence."""

import rclpy
from rclpy.action import ActionClient
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.task import Future

import example_interfaces.action


class Client(Node):
    def __init__(self):
        super().__init__("fibonacci_client")
        self.client = ActionClient(self, example_interfaces.action.Fibonacci, "fibonacci")
        self.finished = Future()

    def start(self):
        self.client.wait_for_server()
        goal = example_interfaces.action.Fibonacci.Goal(order=10)
        self.client.send_goal_async(goal, self.on_feedback).add_done_callback(self.on_accepted)

    def on_feedback(self, message):
        self.get_logger().info(f"Received feedback: {list(message.feedback.sequence)}")

    def on_accepted(self, future):
        future.result().get_result_async().add_done_callback(self.on_result)

    def on_result(self, future):
        self.get_logger().info(f"Result: {list(future.result().result.sequence)}")
        self.finished.set_result(True)


def main():
    rclpy.init()
    node = Client()
    node.start()
    try:
        rclpy.spin_until_future_complete(node, node.finished)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
