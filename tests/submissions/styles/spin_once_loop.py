"""A loop of spin_once with a time-out, and time.time() for the rhythm."""

import time

import rclpy
from spiral import CMD_VEL, PERIOD_S, POSE, SET_PEN, Pose, SetPen, Spiral, Twist

rclpy.init()
node = rclpy.create_node("controller")
poses = []
node.create_subscription(Pose, POSE, poses.append, 10)
velocity = node.create_publisher(Twist, CMD_VEL, 10)
pen = node.create_client(SetPen, SET_PEN)
pen.wait_for_service()
spiral = Spiral()
last = time.time()
while rclpy.ok() and not spiral.done:
    rclpy.spin_once(node, timeout_sec=0.1)
    if time.time() - last >= PERIOD_S:
        last = time.time()
        velocity.publish(spiral.command())
    if not poses:
        continue
    pose = poses.pop()
    if spiral.is_outside(pose):
        velocity.publish(Twist())
    elif request := spiral.pen(pose):
        pen.call_async(request)
while rclpy.ok():
    rclpy.spin_once(node, timeout_sec=0.1)
