"""Wants the simulator to follow /clock for a while, on which it publishes earlier times."""

import threading
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.parameter import Parameter
from rclpy.parameter_client import AsyncParameterClient
from rosgraph_msgs.msg import Clock
from turtlesim.msg import Pose

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
clock = node.create_publisher(Clock, "/clock", 10)
turtlesim = AsyncParameterClient(node, "turtlesim")
poses = []
node.create_subscription(Pose, "/turtle1/pose", poses.append, 10)
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()


def drive():
    twist = Twist()
    twist.linear.x = 1.0
    velocity.publish(twist)


def follow(is_wanted):
    turtlesim.set_parameters([Parameter("use_sim_time", value=is_wanted)])


drive()
time.sleep(0.3)
follow(True)
for second in range(10):
    message = Clock()
    message.clock.sec = second
    clock.publish(message)
    drive()
    time.sleep(0.05)
print(len(poses), poses[-1])
follow(False)
time.sleep(0.1)
drive()
time.sleep(1.5)
print(len(poses), poses[-1])
drive()
time.sleep(1.5)
print(len(poses), poses[-1])
