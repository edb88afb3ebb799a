"""queue, threading.Timer, Event and Condition, a ThreadPoolExecutor, datetime.now."""

import datetime
import queue
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import rclpy
from spiral import CMD_VEL, POSE, Pose, Spiral, Twist

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, CMD_VEL, 10)
poses = queue.Queue()
node.create_subscription(Pose, POSE, poses.put, 10)
threading.Thread(target=lambda: rclpy.spin(node), daemon=True).start()
late, sent = threading.Event(), threading.Condition()
threading.Timer(30.0, late.set).start()
pool = ThreadPoolExecutor(2)
spiral = Spiral()
last = datetime.datetime.now()


def send(twist):
    time.sleep(0.1)
    velocity.publish(twist)
    with sent:
        sent.notify()


while not late.is_set() and not spiral.done:
    try:
        pose = poses.get(timeout=0.05)
    except queue.Empty:
        continue
    spiral.is_outside(pose)
    if (datetime.datetime.now() - last).total_seconds() >= 0.5:
        last = datetime.datetime.now()
        pool.submit(send, spiral.command())
        with sent:
            sent.wait(timeout=1.0)
velocity.publish(Twist())
pool.shutdown()
time.sleep(10)
