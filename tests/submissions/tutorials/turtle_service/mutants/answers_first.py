# In the form of the ROS 2 tutorials' programs.
import math
import threading
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node

from turtle_exercise_interfaces.srv import DrawPolygon


class PolygonService(Node):

    def __init__(self):
        super().__init__('polygon_service')
        self.group = ReentrantCallbackGroup()
        self.srv = self.create_service(
            DrawPolygon, 'draw_polygon', self.draw_polygon_callback, callback_group=self.group)
        self.publisher_ = self.create_publisher(Twist, '/turtle1/cmd_vel', 10)

    def drive(self, linear, angular, duration):
        twist = Twist()
        twist.linear.x = linear
        twist.angular.z = angular
        steps = 10
        for _ in range(steps):
            self.publisher_.publish(twist)
            time.sleep(duration / steps)
        self.publisher_.publish(Twist())
        time.sleep(0.1)

    def draw(self, request):
        for _ in range(request.sides):
            self.drive(1.0, 0.0, request.length)
            self.drive(0.0, 2 * math.pi / request.sides, 1.0)

    def draw_polygon_callback(self, request, response):
        self.get_logger().info(f'Drawing {request.sides} sides of {request.length} m')
        if request.sides < 3:
            response.success = False
            response.message = 'A polygon has at least three sides.'
            return response

        threading.Thread(target=self.draw, args=(request,)).start()

        response.success = True
        response.message = f'Drew {request.sides} sides.'
        return response


def main(args=None):
    rclpy.init(args=args)
    polygon_service = PolygonService()
    executor = MultiThreadedExecutor()
    executor.add_node(polygon_service)
    try:
        executor.spin()
    except KeyboardInterrupt:
        pass

    rclpy.shutdown()


if __name__ == '__main__':
    main()
