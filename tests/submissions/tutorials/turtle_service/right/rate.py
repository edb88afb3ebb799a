"""A rate in the callback; the executor spins in a thread of its own."""
import math
import threading

import rclpy
from geometry_msgs.msg import Twist
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from turtle_exercise_interfaces.srv import DrawPolygon

HZ = 20


class RateDrawer(Node):
    def __init__(self):
        super().__init__("rate_drawer", namespace="")
        group = ReentrantCallbackGroup()
        self.pub = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.rate = self.create_rate(HZ)
        self.create_service(DrawPolygon, "/draw_polygon", self.draw, callback_group=group)

    def send(self, linear, angular, seconds):
        twist = Twist()
        twist.linear.x = float(linear)
        twist.angular.z = float(angular)
        for _ in range(round(seconds * HZ)):
            self.pub.publish(twist)
            self.rate.sleep()

    def draw(self, request, response):
        response.success = request.sides >= 3
        if not response.success:
            response.message = "no polygon has %i sides" % request.sides
            return response
        for _ in range(request.sides):
            self.send(request.length / 2.0, 0, 2)
            self.send(0, 0, 0.2)
            self.send(0, 2 * math.pi / request.sides / 2, 2)
            self.send(0, 0, 0.2)
        response.message = "polygon finished"
        return response


def main(args=None):
    rclpy.init(args=args)
    node = RateDrawer()
    executor = MultiThreadedExecutor()
    executor.add_node(node)
    thread = threading.Thread(target=executor.spin, daemon=True)
    thread.start()
    try:
        thread.join()
    except KeyboardInterrupt:
        pass
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
