"""Fills whatever it may write to: its folder, temporary files, shared memory."""

import os
import tempfile

from tools import achieved

BLOCK = b"x" * (1 << 20)
total = 0
for place in {tempfile.gettempdir(), os.getcwd(), "/tmp", "/var/tmp", "/dev/shm", "/"}:
    for number in range(3):
        try:
            fd = os.open(f"{place}/attack-{number}", os.O_WRONLY | os.O_CREAT, 0o600)
            for _ in range(50):
                total += os.write(fd, BLOCK)
            os.close(fd)
        except OSError:
            pass
if total > 160 << 20:
    achieved("filled the disk", total)
