"""Subscribes to the picture halfway, for a while, with commands in between."""

import threading
import time

import rclpy
from geometry_msgs.msg import Twist
from sensor_msgs.msg import Image

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
heard = []


def drive(linear, angular=0.0):
    twist = Twist()
    twist.linear.x, twist.angular.z = linear, angular
    velocity.publish(twist)


drive(1.0)
time.sleep(0.4)
images = node.create_subscription(
    Image, "/turtlesim/image", lambda m: heard.append((time.time() % 1000, m.header.stamp)), 10
)
time.sleep(0.2)
drive(1.0, 0.5)
time.sleep(0.3)
print(len(heard), heard[:3], heard[-1:])
node.destroy_subscription(images)
time.sleep(0.3)
drive(1.0, -0.5)
time.sleep(0.3)
print(len(heard))
