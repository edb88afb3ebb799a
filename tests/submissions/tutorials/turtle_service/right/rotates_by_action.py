"""Drives by velocity, turns by turtlesim's own action; the callback is async."""
import math

import rclpy
from geometry_msgs.msg import Twist
from rclpy.action import ActionClient
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from turtle_exercise_interfaces.srv import DrawPolygon
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Pose


class Rotator(Node):
    def __init__(self):
        super().__init__("rotator")
        group = ReentrantCallbackGroup()
        self.pose = None
        self.pub = self.create_publisher(Twist, "/turtle1/cmd_vel", 10)
        self.create_subscription(Pose, "/turtle1/pose", self.heard, 10, callback_group=group)
        self.action = ActionClient(
            self, RotateAbsolute, "/turtle1/rotate_absolute", callback_group=group
        )
        self.create_service(DrawPolygon, "draw_polygon", self.draw, callback_group=group)

    def heard(self, pose):
        self.pose = pose

    def forward(self, length):
        x, y = self.pose.x, self.pose.y
        twist = Twist()
        twist.linear.x = 1.0
        clock = self.get_clock()
        while math.hypot(self.pose.x - x, self.pose.y - y) < length - 0.02:
            self.pub.publish(twist)
            clock.sleep_for(rclpy.duration.Duration(seconds=0.02))
        self.pub.publish(Twist())
        clock.sleep_for(rclpy.duration.Duration(seconds=0.1))

    async def draw(self, request, response):
        if request.sides < 3:
            response.success = False
            response.message = "at least 3"
            return response
        self.action.wait_for_server()
        theta = self.pose.theta
        for side in range(request.sides):
            self.forward(request.length)
            goal = RotateAbsolute.Goal()
            goal.theta = theta + 2 * math.pi * (side + 1) / request.sides
            handle = await self.action.send_goal_async(goal)
            await handle.get_result_async()
        response.success = True
        response.message = "done"
        return response


def main():
    rclpy.init()
    executor = MultiThreadedExecutor()
    executor.add_node(Rotator())
    executor.spin()


if __name__ == "__main__":
    main()
