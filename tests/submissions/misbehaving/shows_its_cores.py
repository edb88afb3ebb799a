"""Prints on which cores its threads may run, and moves in the meantime."""

from pathlib import Path

import rclpy
from geometry_msgs.msg import Twist
from rclpy.executors import MultiThreadedExecutor

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
node.create_timer(0.5, lambda: velocity.publish(Twist()))
executor = MultiThreadedExecutor()
executor.add_node(node)
for _ in range(4):
    executor.spin_once()
for thread in Path("/proc/self/task").iterdir():
    lines = (thread / "status").read_text().splitlines()
    print(next(line for line in lines if line.startswith("Cpus_allowed_list")).split()[1])
