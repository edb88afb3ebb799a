#!/usr/bin/env python3
from math import atan2, cos, dist, sin
import rclpy
from geometry_msgs.msg import Twist
from turtlesim.msg import Pose
from turtlesim.srv import Spawn

poses = {}


def keep(name):
    def callback(pose):
        poses[name] = pose
    return callback


def command(leader, me):
    angle = atan2(leader.y - me.y, leader.x - me.x) - me.theta
    twist = Twist()
    twist.linear.x = 3 * max(0.0, dist((leader.x, leader.y), (me.x, me.y)) - 0.6)
    twist.angular.z = 6 * sin(angle) if cos(angle) > 0 else 3.0
    return twist


rclpy.init()
node = rclpy.create_node("follow_me")
client = node.create_client(Spawn, "spawn")
client.wait_for_service()
future = client.call_async(Spawn.Request(x=5.5, y=1.0, theta=1.57, name="turtle2"))
rclpy.spin_until_future_complete(node, future)
name = future.result().name
pub = node.create_publisher(Twist, f"{name}/cmd_vel", 10)
node.create_subscription(Pose, "turtle1/pose", keep("leader"), 10)
node.create_subscription(Pose, f"{name}/pose", keep("me"), 10)
while rclpy.ok():
    rclpy.spin_once(node, timeout_sec=0.1)
    if len(poses) == 2:
        pub.publish(command(**poses))
