"""Sends goals in every tick: to angles that are none, twice the same, cancelled, and unknown."""

import random

import rclpy
from action_msgs.srv import CancelGoal
from geometry_msgs.msg import Twist
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Pose

NAN, INF = float("nan"), float("inf")
rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
impl = RotateAbsolute.Impl
base = "/turtle1/rotate_absolute/_action/"
send = node.create_client(impl.SendGoalService, base + "send_goal")
result = node.create_client(impl.GetResultService, base + "get_result")
cancel = node.create_client(CancelGoal, base + "cancel_goal")
for client in (send, result, cancel):
    client.wait_for_service()
chance = random.Random(1)


def identity():
    return bytes([chance.choice((0, 1, chance.randrange(256)))] * 16)


def on_pose(_):
    for theta in (NAN, INF, 1e38, -0.0, 1.0):
        request = impl.SendGoalService.Request()
        request.goal_id.uuid = list(identity())
        request.goal.theta = theta
        send.call_async(request)
    wanted = impl.GetResultService.Request()
    wanted.goal_id.uuid = list(identity())
    result.call_async(wanted)
    ending = CancelGoal.Request()
    ending.goal_info.goal_id.uuid = list(identity())
    ending.goal_info.stamp.sec = chance.choice((0, -(2**31), 2**31 - 1))
    cancel.call_async(ending)
    twist = Twist()
    twist.linear.x = chance.choice((NAN, INF, -INF, 1e308, 5e-324, 1.0))
    twist.angular.z = chance.choice((NAN, INF, -INF, 1e308, 5e-324, 1.0))
    if chance.random() < 0.1:
        velocity.publish(twist)


node.create_subscription(Pose, "/turtle1/pose", on_pose, 10)
rclpy.spin(node)
