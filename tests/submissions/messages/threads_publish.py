"""Several threads publish, sleep and wait for poses at once."""

import queue
import threading
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import MultiThreadedExecutor
from rclpy.wait_for_message import wait_for_message
from turtlesim.msg import Color, Pose

rclpy.init()
node = rclpy.create_node("controller")
other = rclpy.create_node("other")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
poses = queue.Queue()
node.create_subscription(Pose, "/turtle1/pose", poses.put, 10)
executor = MultiThreadedExecutor(2)
executor.add_node(node)
threading.Thread(target=executor.spin, daemon=True).start()


def now():
    return f"{time.time() % 1000:.4f}"


def drive(linear, angular):
    twist = Twist()
    twist.linear.x, twist.angular.z = linear, angular
    velocity.publish(twist)


def steer(period, angular):
    for i in range(8):
        drive(1.0 + i / 10, angular)
        time.sleep(period)


threads = [threading.Thread(target=steer, args=(0.05 + i / 33, i - 1.0)) for i in range(3)]
for thread in threads:
    thread.start()
print(now(), wait_for_message(Pose, other, "/turtle1/pose", time_to_wait=1.0))
print(now(), wait_for_message(Color, other, "/turtle1/color_sensor", time_to_wait=1.0))
for _ in range(40):
    pose = poses.get()
print(now(), pose, poses.qsize())
for thread in threads:
    thread.join()
while True:
    try:
        last = poses.get(timeout=0.02)
        if last.linear_velocity == 0.0:
            break
    except queue.Empty:
        print("empty", now())
print(now(), last, poses.qsize())
