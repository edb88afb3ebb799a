"""Count as Fibonacci did, and say how far it is."""

import time

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class FibonacciServer(Node):
    """Serves the action fibonacci."""

    def __init__(self):
        super().__init__("fibonacci_action_server")
        self.server = ActionServer(self, Fibonacci, "fibonacci", self.count)

    def count(self, goal_handle):
        """Reach a goal."""
        sequence = [0, 1]
        for _ in range(1, goal_handle.request.order):
            sequence.append(sequence[-1] + sequence[-2])
            goal_handle.publish_feedback(Fibonacci.Feedback(sequence=sequence))
            time.sleep(0.5)
        goal_handle.succeed()
        return Fibonacci.Result(sequence=sequence)


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
