"""Drives by the pose: the callback waits for an event that the subscription sets; clockwise."""
import math
import threading

import rclpy
from geometry_msgs.msg import Twist
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from turtle_exercise_interfaces.srv import DrawPolygon
from turtlesim.msg import Pose


class PolygonByPose(Node):
    def __init__(self):
        super().__init__("polygon_by_pose")
        self.pose = Pose()
        self.goal = None
        self.reached = threading.Event()
        self.cmd = self.create_publisher(Twist, "turtle1/cmd_vel", 10)
        self.create_subscription(
            Pose, "turtle1/pose", self.on_pose, 10,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )
        self.create_service(
            DrawPolygon, "draw_polygon", self.on_request,
            callback_group=MutuallyExclusiveCallbackGroup(),
        )

    def on_pose(self, pose):
        self.pose = pose
        if self.goal is None:
            return
        kind, x, y, theta = self.goal
        twist = Twist()
        if kind == "turn":
            error = math.atan2(math.sin(theta - pose.theta), math.cos(theta - pose.theta))
            finished = abs(error) < 0.01
            twist.angular.z = 0.0 if finished else 2.0 * error
        else:
            error = math.hypot(x - pose.x, y - pose.y)
            finished = error < 0.02
            twist.linear.x = 0.0 if finished else min(2.0, 2.0 * error)
        self.cmd.publish(twist)
        if finished:
            self.goal = None
            self.reached.set()

    def reach(self, *goal):
        self.reached.clear()
        self.goal = goal
        self.reached.wait()

    def on_request(self, request, response):
        if request.sides < 3:
            response.success = False
            response.message = "A polygon needs three sides or more"
            return response
        x, y, theta = self.pose.x, self.pose.y, self.pose.theta
        for _ in range(request.sides):
            x += request.length * math.cos(theta)
            y += request.length * math.sin(theta)
            self.reach("drive", x, y, theta)
            theta -= 2 * math.pi / request.sides
            self.reach("turn", x, y, theta)
        response.success = True
        response.message = "ok"
        return response


def main():
    rclpy.init()
    node = PolygonByPose()
    executor = MultiThreadedExecutor(num_threads=3)
    executor.add_node(node)
    try:
        executor.spin()
    finally:
        node.destroy_node()


if __name__ == "__main__":
    main()
