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


def is_socket(fd):
    with contextlib.suppress(OSError):
        return stat.S_ISSOCK(os.fstat(fd).st_mode)
    return False


# the link before the mailbox, which does not block, whatever their numbers are
for fd in sorted(filter(is_socket, range(3, 100)), key=os.get_blocking, reverse=True):
    with contextlib.suppress(OSError):
        link = socket.socket(fileno=os.dup(fd))
        if link.getsockopt(socket.SOL_SOCKET, socket.SO_TYPE) != socket.SOCK_SEQPACKET:
            continue
        head, parcel = struct.Struct("<cQIQQ?"), struct.Struct("<IIQQI")
        lies = [parcel.pack(number, 0, 10**15, 10**15, 3) + b"lie" for number in range(200)]
        link.send(head.pack(b"A", 0, 0, 2**63, 2**63, True))
        hears = '["/a", "topic /turtle1/pose", "turtlesim/msg/Pose", false, 1, 2, 10, 1048999]'
        link.send(f"T[[{hears}], []]".encode())
        link.send(head.pack(b"M", 0, 0, 0, 0, False) + b"".join(lies))
        link.send(head.pack(b"N", 0, 2, 0, 0, False) + b"\x00\x1b[31mred" * 50)
        time.sleep(0.5)
        link.send(b"T{}")
        link.send(os.urandom(5000))
        link.close()
time.sleep(5.0)
