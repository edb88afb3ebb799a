"""The real clock and thread primitives, kept from before they are replaced.

Import this first; never use `time` for the real clock.
"""

import _thread
import os
import sys
import time
from contextlib import suppress

allocate_lock, get_ident = _thread.allocate_lock, _thread.get_ident
start_new_thread = _thread.start_new_thread
clock_gettime_ns, monotonic, sleep = time.clock_gettime_ns, time.monotonic, time.sleep
gmtime, localtime, strftime = time.gmtime, time.localtime, time.strftime
asctime, ctime = time.asctime, time.ctime


def leave(code: int) -> None:
    """End this process at once: no more destructors, threads, or questions to the clock."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError, AttributeError):
            stream.flush()
    os._exit(code)
