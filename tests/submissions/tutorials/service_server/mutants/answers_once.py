# In the form of the ROS 2 tutorial's program.
import rclpy
from example_interfaces.srv import AddTwoInts
from rclpy.node import Node


class AdditionServer(Node):

    def __init__(self):
        super().__init__('addition_server')
        self.service = self.create_service(AddTwoInts, 'add_two_ints', self.answer)

    def answer(self, request, response):
        response.sum = request.a + request.b
        self.get_logger().info(f'Asked for {request.a} + {request.b}')
        return response


def main():
    rclpy.init()
    server = AdditionServer()
    rclpy.spin_once(server)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
