"""The thread that spins ends by a mistake; the program itself goes on for a while."""

import threading
import time

import rclpy
from turtlesim.msg import Pose


def on_pose(pose):
    print(pose.z)


rclpy.init()
node = rclpy.create_node("controller")
node.create_subscription(Pose, "/turtle1/pose", on_pose, 10)
threading.Thread(target=rclpy.spin, args=(node,)).start()
time.sleep(1.0)
