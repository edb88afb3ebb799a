# In the form of the ROS 2 tutorial's program.
import sys

import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node


class AdditionClient(Node):

    def __init__(self):
        super().__init__('addition_client')
        self.client = self.create_client(AddTwoInts, 'add_two_ints')
        while not self.client.wait_for_service(timeout_sec=1.0):
            self.get_logger().info('Still waiting for the service')
        self.request = AddTwoInts.Request()

    def ask(self, a, b):
        self.request.a = a
        self.request.b = b
        self.future = self.client.call_async(self.request)
        rclpy.spin_until_future_complete(self, self.future)
        return self.future.result()


def main():
    rclpy.init()
    node = AdditionClient()
    a, b = sys.argv[1], sys.argv[2]
    answer = node.ask(a, b)
    node.get_logger().info(
        'Result of add_two_ints: for %d + %d = %d' % (a, b, answer.sum))
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
