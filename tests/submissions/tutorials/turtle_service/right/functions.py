#!/usr/bin/env python3
"""Functions, no class; clockwise, and it turns before it drives."""
import math
import time

import rclpy
from geometry_msgs.msg import Twist
from turtle_exercise_interfaces.srv import DrawPolygon

node = None
pub = None


def stop():
    pub.publish(Twist())
    time.sleep(0.05)


def move(twist, seconds):
    end = time.time() + seconds
    while time.time() < end:
        pub.publish(twist)
        time.sleep(0.01)
    stop()


def draw(req, res):
    n = req.sides
    if n < 3:
        node.get_logger().error("not a polygon")
        res.success, res.message = False, "not a polygon"
        return res
    ahead, turn = Twist(), Twist()
    ahead.linear.x = 1.5
    turn.angular.z = -math.pi / 4
    for _ in range(n):
        move(turn, 8 / n)
        move(ahead, req.length / 1.5)
    res.success, res.message = True, "drew %d sides" % n
    return res


def main():
    global node, pub
    rclpy.init()
    node = rclpy.create_node("draw_polygon_node")
    pub = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
    node.create_service(DrawPolygon, "draw_polygon", draw)
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass
    node.destroy_node()


if __name__ == "__main__":
    main()
