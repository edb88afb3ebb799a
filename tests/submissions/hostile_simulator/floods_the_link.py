"""Writes whatever it likes on both sockets and the page that it shares with the simulator."""

import contextlib
import json
import os
import random
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


def sockets():
    for fd in range(3, 100):
        with contextlib.suppress(OSError):
            if stat.S_ISSOCK(os.fstat(fd).st_mode):
                found = socket.socket(fileno=os.dup(fd))
                if found.getsockopt(socket.SOL_SOCKET, socket.SO_TYPE) == socket.SOCK_SEQPACKET:
                    yield os.get_blocking(fd), found


ends = dict(sockets())
link, mailbox = ends[True], ends[False]
head, parcel = struct.Struct("<cQIQQ?"), struct.Struct("<IIQQI")
chance = random.Random(2)
twist_bytes = b"\0\1\0\0" + struct.pack("<6d", *[float("nan")] * 6)
mail = head.pack(b"M", 0, 0, 0, 0, False)


def lies():
    for number in range(400):
        data = chance.choice((b"", twist_bytes, b"\0\1\0\0" + b"\xff" * chance.randrange(60)))
        client, serial = chance.getrandbits(32), chance.getrandbits(64)
        yield parcel.pack(number, client, serial, 0, len(data)) + data


empty = b"".join(parcel.pack(number % 60, 0, 0, 0, 0) for number in range(5000))
for turn in range(60):
    with contextlib.suppress(BlockingIOError):
        for _ in range(10):
            mailbox.send(mail + b"".join(lies()))
            mailbox.send(mail + empty)
        mailbox.sendmsg(
            [mail], [(socket.SOL_SOCKET, socket.SCM_RIGHTS, struct.pack("3i", 0, 1, 2))]
        )
    kind, first = ("std_msgs/msg/String", True, 1, 2, 10), (1 << 20) + 1000 + 200 * turn
    topics = [["/a", f"topic /t{turn}_{n}", *kind, first + n] for n in range(200)]
    link.send(b"T" + json.dumps([topics, []]).encode())
    link.send(head.pack(b"N", 0, 2, 0, 0, False) + b"\xff" * 100)
    link.send(head.pack(b"A", 2**64 - 1, 1, 2**64 - 1, 0, True))
    link.recv(200_000)
# in pieces, of which there is no end
mailbox.setblocking(True)
piece = b"+" + bytes(150_000)
for _ in range(2_000):
    mailbox.send(piece)
    link.send(head.pack(b"A", 0, 0, 0, 0, True))
    link.recv(200_000)
