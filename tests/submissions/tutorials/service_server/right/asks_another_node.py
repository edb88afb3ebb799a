"""Two nodes in one executor: one serves, and lets the other do the sum."""

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


class Calculator(Node):
    def __init__(self):
        super().__init__("calculator")
        self.create_service(AddTwoInts, "calculate", self.calculate)

    def calculate(self, request, response):
        response.sum = request.a + request.b
        return response


class FrontDesk(Node):
    def __init__(self):
        super().__init__("front_desk")
        group = ReentrantCallbackGroup()
        self.client = self.create_client(AddTwoInts, "calculate", callback_group=group)
        self.create_service(AddTwoInts, "add_two_ints", self.pass_on, callback_group=group)

    async def pass_on(self, request, response):
        response.sum = (await self.client.call_async(request)).sum
        return response


def main():
    rclpy.init()
    executor = MultiThreadedExecutor()
    calculator, desk = Calculator(), FrontDesk()
    executor.add_node(calculator)
    executor.add_node(desk)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
