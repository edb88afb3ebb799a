import sys

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node


class Client(Node):
    def __init__(self):
        super().__init__('client')
        self.adder = self.create_client(AddTwoInts, 'add_two_ints')

    def add(self, a, b):
        self.adder.wait_for_service()
        future = self.adder.call_async(AddTwoInts.Request(a=a, b=b))
        rclpy.spin_until_future_complete(self, future)
        return future.result().sum


def main(args=None):
    rclpy.init(args=args)
    a, b = int(sys.argv[1]), int(sys.argv[2])
    client = Client()
    total = client.add(a, b)
    client.get_logger().info(f'Result of add_two_ints: for {a} + {b} = {total}')
    client.destroy_node()
    rclpy.shutdown()
