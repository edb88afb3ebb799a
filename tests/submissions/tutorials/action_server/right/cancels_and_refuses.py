"""Refuses orders below 1 and above 40, and stops where it is asked to."""

import time

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer, CancelResponse, GoalResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


class FibonacciServer(Node):
    def __init__(self):
        super().__init__("fibonacci_server")
        self.server = ActionServer(
            self,
            Fibonacci,
            "fibonacci",
            execute_callback=self.execute,
            goal_callback=self.on_goal,
            cancel_callback=self.on_cancel,
            callback_group=ReentrantCallbackGroup(),
        )

    def on_goal(self, goal):
        if not 1 <= goal.order <= 40:
            self.get_logger().warn(f"Refused: order {goal.order}")
            return GoalResponse.REJECT
        return GoalResponse.ACCEPT

    def on_cancel(self, handle):
        self.get_logger().info("I am to stop")
        return CancelResponse.ACCEPT

    def execute(self, handle):
        sequence = [0, 1]
        for _ in range(handle.request.order - 1):
            if handle.is_cancel_requested:
                handle.canceled()
                return Fibonacci.Result(sequence=sequence)
            sequence.append(sequence[-1] + sequence[-2])
            handle.publish_feedback(Fibonacci.Feedback(sequence=sequence))
            time.sleep(0.5)
        handle.succeed()
        return Fibonacci.Result(sequence=sequence)


def main():
    rclpy.init()
    executor = MultiThreadedExecutor()
    executor.add_node(FibonacciServer())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
