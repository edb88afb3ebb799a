"""A daemon takes every lock that it finds, and every port of every ROS domain."""

import ctypes
import fcntl
import glob
import os
import struct

import known
from tools import daemon, for_a_minute, libc


def keep():
    kept = []
    for path in glob.glob("/tmp/turtlesim-grader-*/*.lock") + [
        f"/tmp/turtlesim-grader-{known.USER}/{name}"
        for name in [f"core-{n}.lock" for n in range(8)]
        + [f"domain-{n}.lock" for n in (*range(40, 102), *range(215, 233))]
    ]:
        try:
            fd = os.open(path, os.O_RDWR | os.O_CREAT | os.O_NONBLOCK, 0o666)
            fcntl.flock(fd, fcntl.LOCK_EX | fcntl.LOCK_NB)
            kept.append(fd)
        except OSError:
            pass
    for domain in range(102):
        for offset in (0, 10, 11):
            fd = libc.socket(2, 2, 0)
            address = (
                struct.pack("=H", 2) + struct.pack(">H", 7400 + 250 * domain + offset) + bytes(12)
            )
            libc.bind(fd, ctypes.create_string_buffer(address, 16), 16)
    for_a_minute()


daemon(keep)
