"""Two nodes in two executors in two threads, a topic between them, poses as sensor data."""

import threading

import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import qos_profile_sensor_data
from spiral import CMD_VEL, PERIOD_S, POSE, Pose, Spiral, Twist

rclpy.init()
eyes, legs = rclpy.create_node("eyes"), rclpy.create_node("legs")
seen = eyes.create_publisher(Pose, "seen", 10)
eyes.create_subscription(Pose, POSE, seen.publish, qos_profile_sensor_data)
velocity = legs.create_publisher(Twist, CMD_VEL, 10)
spiral = Spiral()


def on_seen(pose):
    if not spiral.done and spiral.is_outside(pose):
        velocity.publish(Twist())


def on_timer():
    if not spiral.done:
        velocity.publish(spiral.command())


legs.create_subscription(Pose, "seen", on_seen, 10)
legs.create_timer(PERIOD_S, on_timer)
first, second = SingleThreadedExecutor(), SingleThreadedExecutor()
first.add_node(eyes)
second.add_node(legs)
threading.Thread(target=first.spin, daemon=True).start()
second.spin()
