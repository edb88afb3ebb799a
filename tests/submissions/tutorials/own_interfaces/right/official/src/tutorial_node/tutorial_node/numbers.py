import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

from tutorial_interfaces.msg import Num
from tutorial_interfaces.srv import AddThreeInts


class Numbers(Node):

    def __init__(self):
        super().__init__('numbers')
        self.publisher_ = self.create_publisher(Num, 'topic', 10)
        self.timer = self.create_timer(0.5, self.timer_callback)
        self.i = 0
        self.srv = self.create_service(AddThreeInts, 'add_three_ints', self.add_callback)

    def timer_callback(self):
        msg = Num()
        msg.num = self.i
        self.publisher_.publish(msg)
        self.get_logger().info('Publishing: "%d"' % msg.num)
        self.i += 1

    def add_callback(self, request, response):
        response.sum = request.a + request.b + request.c
        self.get_logger().info('Incoming request')
        return response


def main(args=None):
    rclpy.init(args=args)
    numbers = Numbers()
    try:
        rclpy.spin(numbers)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        numbers.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
