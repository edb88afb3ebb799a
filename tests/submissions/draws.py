"""Draws from whatever there is to draw from, says what it got, and steers by it."""

import _datetime
import _random
import getpass
import os
import random
import resource
import secrets
import ssl
import time
import uuid

import rclpy
from geometry_msgs.msg import Twist


def opened(path):
    number = os.open(path, os.O_RDONLY)
    with open(path, "rb") as file:  # noqa: PTH123
        return os.read(number, 8) + file.read(8)


def busy(clock):
    """Ends where a clock of processor time goes on."""
    end = clock() + 0.01
    while clock() < end:
        pass
    return clock()


DRAWS = {
    "random.random": random.random,
    "random.seed": lambda: random.seed() or random.random(),
    "random.Random": lambda: random.Random().random(),
    "random.SystemRandom": lambda: random.SystemRandom().random(),
    "_random.Random": lambda: _random.Random().random(),
    "a class of _random.Random": lambda: type("Own", (_random.Random,), {})().random(),
    "os.urandom": lambda: os.urandom(8),
    "os.getrandom": lambda: os.getrandom(8),
    "/dev/urandom": lambda: opened("/dev/urandom"),
    "/dev/random": lambda: opened("/dev/random"),
    "secrets": secrets.token_hex,
    "ssl": lambda: ssl.RAND_bytes(8),
    "uuid1": uuid.uuid1,
    "uuid4": uuid.uuid4,
    "asctime": time.asctime,
    "_datetime": _datetime.datetime.now,
    "process_time": lambda: busy(time.process_time),
    "thread_time_ns": lambda: busy(lambda: time.thread_time_ns() / 1e9),
    "clock_gettime": lambda: busy(lambda: time.clock_gettime(time.CLOCK_PROCESS_CPUTIME_ID)),
    "os.times": lambda: busy(lambda: os.times().user),
    "getrusage": lambda: busy(lambda: resource.getrusage(resource.RUSAGE_SELF).ru_utime),
    "uid": lambda: (os.getuid(), os.getegid(), getpass.getuser()),
}

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
said = []
for name, draw in DRAWS.items():
    said.append(f"{name}: {draw()}")
    print(said[-1], flush=True)
twist = Twist()
twist.linear.x = 1.0 + sum("".join(said).encode()) % 1000 / 1000
node.create_timer(0.1, lambda: velocity.publish(twist))
rclpy.spin(node)
