#!/usr/bin/env python3
import math
from functools import partial

import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose

from my_robot_interfaces.msg import TurtleArray
from my_robot_interfaces.srv import CatchTurtle


class TurtleControllerNode(Node):

    def __init__(self):
        super().__init__('turtle_controller')
        self.declare_parameter('catch_closest_turtle_first', True)
        self.closest_first_ = self.get_parameter(
            'catch_closest_turtle_first').value
        self.pose_ = None
        self.turtle_to_catch_ = None

        self.cmd_vel_publisher_ = self.create_publisher(
            Twist, 'turtle1/cmd_vel', 10)
        self.pose_subscriber_ = self.create_subscription(
            Pose, 'turtle1/pose', self.callback_pose, 10)
        self.alive_turtles_subscriber_ = self.create_subscription(
            TurtleArray, 'alive_turtles', self.callback_alive_turtles, 10)
        self.catch_turtle_client_ = self.create_client(
            CatchTurtle, 'catch_turtle')
        self.control_loop_timer_ = self.create_timer(0.01, self.control_loop)

    def callback_pose(self, pose):
        self.pose_ = pose

    def callback_alive_turtles(self, msg):
        if len(msg.turtles) == 0 or self.pose_ is None:
            return
        if self.closest_first_:
            self.turtle_to_catch_ = min(msg.turtles, key=self.distance_to)
        else:
            self.turtle_to_catch_ = msg.turtles[0]

    def distance_to(self, turtle):
        return math.sqrt((turtle.x - self.pose_.x) ** 2
                         + (turtle.y - self.pose_.y) ** 2)

    def control_loop(self):
        if self.pose_ is None or self.turtle_to_catch_ is None:
            return

        distance = self.distance_to(self.turtle_to_catch_)
        cmd = Twist()
        if distance > 0.5:
            cmd.linear.x = 2 * distance

            goal_theta = math.atan2(self.turtle_to_catch_.y - self.pose_.y,
                                    self.turtle_to_catch_.x - self.pose_.x)
            diff = goal_theta - self.pose_.theta
            if diff > math.pi:
                diff -= 2 * math.pi
            elif diff < -math.pi:
                diff += 2 * math.pi
            cmd.angular.z = 6 * diff
        else:
            self.call_catch_turtle_service(self.turtle_to_catch_.name)
            self.turtle_to_catch_ = None
        self.cmd_vel_publisher_.publish(cmd)

    def call_catch_turtle_service(self, name):
        while not self.catch_turtle_client_.wait_for_service(1.0):
            self.get_logger().warn('Waiting for catch_turtle service...')

        request = CatchTurtle.Request()
        request.name = name
        future = self.catch_turtle_client_.call_async(request)
        future.add_done_callback(
            partial(self.callback_call_catch_turtle, name=name))

    def callback_call_catch_turtle(self, future, name):
        if not future.result().success:
            self.get_logger().error('Could not catch ' + name)


def main(args=None):
    rclpy.init(args=args)
    node = TurtleControllerNode()
    rclpy.spin(node)
    rclpy.shutdown()


if __name__ == '__main__':
    main()
