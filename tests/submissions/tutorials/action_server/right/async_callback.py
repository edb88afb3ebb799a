"""Waits in a coroutine, for a timer."""

import rclpy
from example_interfaces.action import Fibonacci
from rclpy.action import ActionServer
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.task import Future


class FibonacciServer(Node):
    def __init__(self):
        super().__init__("fibonacci_server")
        self.server = ActionServer(self, Fibonacci, "fibonacci", self.execute)

    async def sleep(self, seconds):
        future = Future()
        timer = self.create_timer(seconds, lambda: future.set_result(None))
        await future
        self.destroy_timer(timer)

    async def execute(self, handle):
        a, b = 0, 1
        feedback = Fibonacci.Feedback(sequence=[a, b])
        for _ in range(1, handle.request.order):
            a, b = b, a + b
            feedback.sequence.append(b)
            handle.publish_feedback(feedback)
            await self.sleep(0.5)
        handle.succeed()
        result = Fibonacci.Result()
        result.sequence = feedback.sequence
        return result


def main():
    rclpy.init()
    try:
        rclpy.spin(FibonacciServer())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
