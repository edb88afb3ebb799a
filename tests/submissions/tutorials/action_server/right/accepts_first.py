"""Accepts a goal, and executes it from a timer."""

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer, GoalResponse
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node


class FibonacciServer(Node):
    def __init__(self):
        super().__init__("fibonacci_server")
        self.waiting = []
        self.server = ActionServer(
            self,
            Fibonacci,
            "fibonacci",
            self.execute,
            goal_callback=lambda goal: GoalResponse.ACCEPT,
            handle_accepted_callback=self.waiting.append,
        )
        self.create_timer(0.2, self.work)

    def work(self):
        if self.waiting:
            self.waiting.pop(0).execute()

    def execute(self, handle):
        sequence = [0, 1]
        for _ in range(1, handle.request.order):
            sequence.append(sequence[-1] + sequence[-2])
            handle.publish_feedback(Fibonacci.Feedback(sequence=sequence))
        handle.succeed()
        return Fibonacci.Result(sequence=sequence)


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    executor.add_node(FibonacciServer())
    executor.add_node(Node("nothing_to_do"))
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
