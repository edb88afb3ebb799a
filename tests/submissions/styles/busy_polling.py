"""spin_once that never waits, the ROS clock for the rhythm, and busy waiting at the end."""

import rclpy
from rclpy.duration import Duration
from spiral import CMD_VEL, PERIOD_S, POSE, Pose, Spiral, Twist

rclpy.init()
node = rclpy.create_node("controller")
poses = []
node.create_subscription(Pose, POSE, poses.append, 10)
velocity = node.create_publisher(Twist, CMD_VEL, 10)
spiral = Spiral()
last = node.get_clock().now()
while not spiral.done:
    rclpy.spin_once(node, timeout_sec=0)
    if node.get_clock().now() - last > Duration(seconds=PERIOD_S):
        last = node.get_clock().now()
        velocity.publish(spiral.command())
    if poses:
        spiral.is_outside(poses.pop())
velocity.publish(Twist())
while rclpy.ok():
    pass
