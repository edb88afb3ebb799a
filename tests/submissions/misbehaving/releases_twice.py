"""A thread that releases a lock which nobody holds; the main thread drives on."""

import threading

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)


def worker():
    lock = threading.Lock()
    with lock:
        pass
    lock.release()


thread = threading.Thread(target=worker)
thread.start()
thread.join()
twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
