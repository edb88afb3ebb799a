"""Publishes bytes: good ones, cut off ones, none, garbage; and hears messages as bytes."""

import rclpy
from geometry_msgs.msg import Twist
from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import String
from turtlesim.msg import Pose

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
chatter = node.create_publisher(String, "/chatter", 10)
count = 0


def good(speed):
    twist = Twist()
    twist.linear.x = speed
    return serialize_message(twist)


SENT = {
    10: (velocity, good(1.0)),
    20: (chatter, b"\x00\x01\x00\x00\x03\x00\x00\x00hi\x00"),
    30: (velocity, good(2.0)[:20]),
    40: (velocity, b"\x00\x01\x00\x00" + b"\xff" * 2),
    50: (chatter, b"\x00\x01\x00\x00\xff\xff\x00\x00hi"),
    60: (velocity, good(1.5)),
    70: (chatter, b"\x00\x01\x00\x00\x03\x00\x00\x00ho\x00"),
    100: (velocity, b""),
    110: (velocity, good(0.5)),
}


def on_pose(data):
    global count
    count += 1
    if count in SENT:
        publisher, sent = SENT[count]
        publisher.publish(sent)
        print(count, data.hex(), deserialize_message(data, Pose), flush=True)


node.create_subscription(Pose, "/turtle1/pose", on_pose, 10, raw=True)
node.create_subscription(String, "/chatter", lambda m: print(count, m), 5)
node.create_subscription(String, "/chatter", lambda m: print(count, m), 5, raw=True)
rclpy.spin(node)
