"""The callback spins a node of its own, which hears the pose."""
import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from turtle_exercise_interfaces.srv import DrawPolygon
from turtlesim.msg import Pose


class Driver(Node):
    def __init__(self):
        super().__init__("polygon_driver")
        self.pose = None
        self.publisher = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "/turtle1/pose", self.hear, 1)
        self.executor_ = SingleThreadedExecutor()
        self.executor_.add_node(self)

    def hear(self, pose):
        self.pose = pose

    def wait(self):
        self.pose = None
        while self.pose is None:
            self.executor_.spin_once(timeout_sec=0.5)
        return self.pose

    def send(self, x, z):
        twist = Twist()
        twist.linear.x = x
        twist.angular.z = z
        self.publisher.publish(twist)

    def forward(self, length):
        start = self.wait()
        while True:
            pose = self.wait()
            left = length - math.dist((start.x, start.y), (pose.x, pose.y))
            if left < 0.01:
                break
            self.send(min(1.5, max(0.1, 2 * left)), 0.0)
        self.send(0.0, 0.0)

    def turn(self, angle):
        wanted = self.wait().theta + angle
        while True:
            left = math.remainder(wanted - self.wait().theta, 2 * math.pi)
            if abs(left) < 0.005:
                break
            self.send(0.0, max(-1.5, min(1.5, 3 * left)))
        self.send(0.0, 0.0)
        self.wait()


class PolygonServer(Node):
    def __init__(self, driver):
        super().__init__("polygon_server")
        self.driver = driver
        self.create_service(DrawPolygon, "draw_polygon", self.draw)

    def draw(self, request, response):
        if request.sides < 3:
            response.success = False
            response.message = "need at least 3 sides"
            return response
        for _ in range(request.sides):
            self.driver.forward(request.length)
            self.driver.turn(2 * math.pi / request.sides)
        response.success = True
        response.message = "polygon drawn"
        return response


def main(args=None):
    rclpy.init(args=args)
    driver = Driver()
    server = PolygonServer(driver)
    rclpy.spin(server)


if __name__ == "__main__":
    main()
