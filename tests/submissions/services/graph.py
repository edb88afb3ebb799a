"""Asks the graph before it drives, as careful students do."""

import time

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("controller")
while "turtlesim" not in node.get_node_names():
    time.sleep(0.1)
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
while velocity.get_subscription_count() == 0:
    rclpy.spin_once(node, timeout_sec=0.1)
print(sorted(node.get_node_names()))
print(sorted(name for name, _ in node.get_topic_names_and_types()))
print(sorted(name for name, _ in node.get_service_names_and_types() if "_action" not in name))
for topic in ("/turtle1/cmd_vel", "/turtle1/pose"):
    print(topic, node.count_publishers(topic), node.count_subscribers(topic))
print([info.node_name for info in node.get_publishers_info_by_topic("/turtle1/pose")])
print(node.get_publisher_names_and_types_by_node("turtlesim", "/"))
print(time.time())
twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
time.sleep(2.0)
