"""Count as Fibonacci did, and say how far it is. Fill in the three TODOs."""

import time  # noqa: F401  for a pause between two numbers

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer  # noqa: F401  you will need it
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class FibonacciServer(Node):
    """Serves the action fibonacci."""

    def __init__(self):
        super().__init__("fibonacci_action_server")
        # TODO 1: create an ActionServer of Fibonacci, called fibonacci, that calls count().

    def count(self, goal_handle):
        """Called with each goal: goal_handle.request.order."""
        feedback = Fibonacci.Feedback()
        feedback.sequence = [0, 1]
        # TODO 2: append the sum of the last two numbers, order - 1 times, and publish the feedback
        #         each time.
        result = Fibonacci.Result()
        # TODO 3: say that the goal has succeeded, and put the sequence into the result.
        return result


def main(args=None):
    """Run the node until Ctrl-C."""
    rclpy.init(args=args)
    try:
        rclpy.spin(FibonacciServer())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
