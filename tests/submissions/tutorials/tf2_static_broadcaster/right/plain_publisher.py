"""Publishes on /tf_static without a broadcaster."""

import argparse
import math

import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from tf2_msgs.msg import TFMessage


def multiply(a, b):
    return (
        a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
        a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
        a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
        a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2],
    )


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("name")
    for each in ("x", "y", "z", "roll", "pitch", "yaw"):
        parser.add_argument(each, type=float)
    args, _ = parser.parse_known_args()

    rclpy.init()
    node = Node("static_turtle_tf2_broadcaster")
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publisher = node.create_publisher(TFMessage, "/tf_static", latched)

    t = TransformStamped(child_frame_id=args.name)
    t.header.frame_id = "world"
    t.header.stamp = node.get_clock().now().to_msg()
    move = t.transform.translation
    move.x, move.y, move.z = args.x, args.y, args.z
    about_x = (math.sin(args.roll / 2), 0.0, 0.0, math.cos(args.roll / 2))
    about_y = (0.0, math.sin(args.pitch / 2), 0.0, math.cos(args.pitch / 2))
    about_z = (0.0, 0.0, math.sin(args.yaw / 2), math.cos(args.yaw / 2))
    turn = t.transform.rotation
    turn.x, turn.y, turn.z, turn.w = multiply(about_z, multiply(about_y, about_x))
    publisher.publish(TFMessage(transforms=[t]))
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    rclpy.try_shutdown()


if __name__ == "__main__":
    main()
