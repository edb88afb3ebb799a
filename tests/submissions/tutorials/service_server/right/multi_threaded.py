import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node


class Adder(Node):
    def __init__(self):
        super().__init__("adder")
        self.group = ReentrantCallbackGroup()
        self.srv = self.create_service(
            AddTwoInts, "add_two_ints", self.on_request, callback_group=self.group
        )

    def on_request(self, request: AddTwoInts.Request, response: AddTwoInts.Response):
        a, b = request.a, request.b
        response.sum = a + b
        self.get_logger().info(f"{a} + {b} = {response.sum}")
        return response


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=2)
    executor.add_node(Adder())
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass


if __name__ == "__main__":
    main()
