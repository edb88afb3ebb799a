"""Finds the link to the simulator; sends lies, nonsense, floods, and then hangs up."""

import os

from tools import libc

PACKETS = [
    b"A" + b"\xff" * 28 + b"\1",
    b'T[[["/a", "topic /turtle1/pose", "turtlesim/msg/Pose", false, 1, 2, 10, 1048999]], []]',
    b"T" + b"[" * 60_000,
    b"M" + bytes(29) + b"\xff" * 4000,
    b"N" + bytes(29) + b"\x1b[31mred" * 50,
    b"T{}",
    b"",
    os.urandom(60_000),
]
for fd in range(3, 64):
    for packet in PACKETS * 20:
        libc.send(fd, packet, len(packet), 0x4040)
