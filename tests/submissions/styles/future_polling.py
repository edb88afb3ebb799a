"""A spin thread, and the main thread that waits busily for each answer."""

import threading
import time

import rclpy
from spiral import CMD_VEL, SET_PEN, SetPen, Spiral, Twist

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, CMD_VEL, 10)
pen = node.create_client(SetPen, SET_PEN)
threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()
spiral = Spiral()
for turn in range(10):
    answer = pen.call_async(SetPen.Request(r=25 * turn, g=0, b=0, width=3))
    while not answer.done():
        pass
    velocity.publish(spiral.command())
    time.sleep(0.5)
velocity.publish(Twist())
time.sleep(100)
