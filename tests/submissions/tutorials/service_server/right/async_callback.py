import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class Adder(Node):
    def __init__(self):
        super().__init__("adder")
        self.create_service(AddTwoInts, "add_two_ints", self.add)

    async def add(self, request, response):
        response.sum = await self.sum_of(request.a, request.b)
        return response

    async def sum_of(self, *numbers):
        return sum(numbers)


def main():
    rclpy.init()
    try:
        rclpy.spin(Adder())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
