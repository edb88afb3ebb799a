"""wait_for_message for the pose, Clock.sleep_for and sleep_until for the rhythm."""

import rclpy
from rclpy.duration import Duration
from rclpy.wait_for_message import wait_for_message
from spiral import CMD_VEL, POSE, Pose, Spiral, Twist

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, CMD_VEL, 10)
clock = node.get_clock()
spiral = Spiral()
while rclpy.ok():
    found, pose = wait_for_message(Pose, node, POSE, time_to_wait=2.0)
    if not found or spiral.is_outside(pose):
        break
    velocity.publish(spiral.command())
    clock.sleep_for(Duration(seconds=0.25))
    clock.sleep_until(clock.now() + Duration(seconds=0.25))
velocity.publish(Twist())
clock.sleep_for(Duration(seconds=10))
