"""The real clock and thread primitives, taken before anything of them is replaced.

Import this first, and `time` for anything else never.
"""

import os
import sys
from _thread import allocate_lock, get_ident, start_new_thread
from contextlib import suppress
from time import (
    asctime,
    clock_gettime_ns,
    ctime,
    gmtime,
    localtime,
    monotonic,
    sleep,
    strftime,
)

__all__ = [
    "allocate_lock",
    "asctime",
    "clock_gettime_ns",
    "ctime",
    "get_ident",
    "gmtime",
    "leave",
    "localtime",
    "monotonic",
    "sleep",
    "start_new_thread",
    "strftime",
]


def leave(code: int) -> None:
    """End this process at once: no more destructors, threads, or questions to the clock."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError, AttributeError):
            stream.flush()
    os._exit(code)
