"""Sends packets to the ports at which DDS listens: headers of RTPS with nonsense behind."""

import random

from tools import attempt, connect, inet, libc

chance = random.Random(1)
head = b"RTPS\x02\x03\x01\x0f" + bytes(range(12))
for domain in (0, *range(40, 60)):
    for offset in (0, 1, 10, 11, 12, 13):
        with attempt():
            fd = connect(2, 2, inet(7400 + 250 * domain + offset))
            for length in (4, 20, 60, 400, 1400):
                kind = bytes([chance.choice((0x09, 0x15, 0x07, 0x06, 0x0E, 0x08, 0x01)), 1])
                size = chance.choice((0, 1, 65535, length)).to_bytes(2, "little")
                packet = head + kind + size + chance.randbytes(length)
                libc.send(fd, packet, len(packet), 0x4040)
            libc.close(fd)
