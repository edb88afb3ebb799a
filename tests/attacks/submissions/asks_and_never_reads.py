"""Asks the simulator for time, again and again, and never reads an answer."""

import struct

from tools import libc, rest

ask = struct.pack("<cQIQQ?", b"A", 1 << 40, 0, 1 << 40, 1 << 40, True)
for _ in range(200):
    for fd in range(3, 64):
        libc.send(fd, ask, len(ask), 0x4040)
    rest(0.005)
