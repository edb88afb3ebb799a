"""Finds the link to the simulator and tells it lies, then nonsense, then nothing."""

import contextlib
import os
import socket
import stat
import struct
import time

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
rclpy.spin_once(node, timeout_sec=0.1)
for fd in range(3, 100):
    with contextlib.suppress(OSError):
        if stat.S_ISSOCK(os.fstat(fd).st_mode):
            link = socket.socket(fileno=os.dup(fd))
            if link.getsockopt(socket.SOL_SOCKET, socket.SO_TYPE) != socket.SOCK_SEQPACKET:
                continue
            lies = b"".join(struct.pack("<IQ", number, 10**15) for number in range(200))
            link.send(b"H" + struct.pack("<QI", 10**9, 0) + lies)
            link.send(b"A" + struct.pack("<QI", 2**63, 5) + lies)
            link.send(b"A" + struct.pack("<QI", 0, 0) + lies[:24] * 3)
            link.send(b"N" + struct.pack("<QI", 0, 4) + b"\x00\x1b[31mred" * 50)
            time.sleep(0.5)
            link.send(b"T{}")
            link.send(os.urandom(5000))
            link.close()
time.sleep(5.0)
