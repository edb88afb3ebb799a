"""A subscription that does not fit is gone before anybody could tell of it."""

import threading
import time

import rclpy
from geometry_msgs.msg import Twist
from rclpy.qos import QoSDurabilityPolicy, QoSProfile
from std_msgs.msg import String
from turtlesim.msg import Pose

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
lasting = QoSProfile(depth=1, durability=QoSDurabilityPolicy.TRANSIENT_LOCAL)
subscription = node.create_subscription(String, "words", print, lasting)
time.sleep(0.1)
publisher = node.create_publisher(String, "words", 1)
publisher.publish(String(data="unheard"))
node.destroy_subscription(subscription)
time.sleep(0.1)
twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
for _ in range(10):
    passing = node.create_subscription(Pose, "/turtle1/pose", print, lasting)
    velocity.get_subscription_count()
    node.destroy_subscription(passing)
    time.sleep(0.02)
