import math
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.node import Node
from turtle_exercise_interfaces.srv import DrawPolygon


class DrawPolygonServer(Node):
    """A timer sends what the callback sets, ten times a second."""

    def __init__(self):
        super().__init__('draw_polygon_server')
        self.declare_parameter('speed', 1.0)
        self.declare_parameter('turning_speed', 0.5)
        self.twist = Twist()
        self.publisher = self.create_publisher(Twist, 'turtle1/cmd_vel', 10)
        self.timer = self.create_timer(
            0.1, self.send, callback_group=MutuallyExclusiveCallbackGroup())
        self.service = self.create_service(
            DrawPolygon, 'draw_polygon', self.on_request,
            callback_group=MutuallyExclusiveCallbackGroup())

    def send(self):
        self.publisher.publish(self.twist)

    def move(self, linear, angular, seconds):
        twist = Twist()
        twist.linear.x = linear
        twist.angular.z = angular
        self.twist = twist
        self.send()
        time.sleep(seconds)
        self.twist = Twist()
        self.send()

    def on_request(self, request, response):
        if request.sides < 3:
            response.success = False
            response.message = f'A polygon with {request.sides} sides does not exist'
            self.get_logger().warning(response.message)
            return response
        speed = self.get_parameter('speed').value
        turning = self.get_parameter('turning_speed').value
        for side in range(request.sides):
            self.get_logger().info(f'side {side + 1}')
            self.move(speed, 0.0, request.length / speed)
            self.move(0.0, turning, 2 * math.pi / request.sides / turning)
        response.success = True
        response.message = 'done'
        return response


def main(args=None):
    rclpy.init(args=args)
    server = DrawPolygonServer()
    executor = MultiThreadedExecutor()
    executor.add_node(server)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        server.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
