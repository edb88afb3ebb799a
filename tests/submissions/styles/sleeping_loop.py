"""time.sleep for the rhythm, a few spin_once in between: sees old poses."""

import time

import rclpy
from spiral import CMD_VEL, PERIOD_S, POSE, SET_PEN, Pose, SetPen, Spiral, Twist

rclpy.init()
node = rclpy.create_node("controller")
poses = []
node.create_subscription(Pose, POSE, poses.append, 1)
velocity = node.create_publisher(Twist, CMD_VEL, 10)
pen = node.create_client(SetPen, SET_PEN)
spiral = Spiral()
while rclpy.ok():
    for _ in range(3):
        rclpy.spin_once(node, timeout_sec=0)
    if poses:
        pose = poses[-1]
        if spiral.is_outside(pose):
            velocity.publish(Twist())
            break
        if request := spiral.pen(pose):
            pen.call_async(request)
    velocity.publish(spiral.command())
    time.sleep(PERIOD_S)
while True:
    time.sleep(1.0)
