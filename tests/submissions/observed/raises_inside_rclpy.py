"""What it gives to rclpy is wrong, so that the last line of the traceback is rclpy's."""

import rclpy

rclpy.init()
node = rclpy.create_node("controller")


def tick():
    node.create_publisher(int, "/turtle1/cmd_vel", 10)


node.create_timer(0.5, tick)
rclpy.spin(node)
