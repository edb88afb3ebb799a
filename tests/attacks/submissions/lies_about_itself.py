"""Finds the page in which our own code tells of this process; lies there, and makes it larger."""

import fcntl
import json
import os
import struct
import zlib
from contextlib import suppress

HOSTILE = '<script>alert(1)</script>\x1b[31m\n::error::\u202e=HYPERLINK("x")'
PLACE = {"file": "../../../../etc/passwd", "line": 1, "function": HOSTILE, "text": HOSTILE}
END = {
    **{"kind": "publisher", "name": HOSTILE, "type": HOSTILE, "is_met": True, "used": 2**52},
    **{"place": PLACE, "used_at": PLACE, "lines": [PLACE], "sent": []},
}
LIE = {
    **{"is_blind": False, "ends": [END], "waits": [], "slow": [], "timers": [], "caught": []},
    **{"spun_s": 0.0, "stop": None, "returned_s": 0.0},
    "raised": {"type": HOSTILE, "text": HOSTILE, "time_s": 1e300, "place": PLACE},
}
DUMP = f"""Fatal Python error: Aborted

Current thread 0x00 (most recent call first):
  File "{os.getcwd()}/../../../../etc/passwd", line 1 in {"x" * 400}
"""

for fd in range(3, 64):
    with suppress(OSError):
        if "memfd:account" in os.readlink(f"/proc/self/fd/{fd}"):
            os.write(fd, DUMP.encode())
            data = json.dumps(LIE).encode()
            for number in (2**62, 2**62 + 1):
                head = struct.pack(
                    "<IQI?3x", zlib.crc32(data, number & 0xFFFFFFFF), number, len(data), True
                )
                os.pwrite(fd, head + data, 49_152 * (number % 2))
            for grow in (lambda: os.ftruncate(fd, 2**40), lambda: fcntl.fcntl(fd, 1033, 0)):
                with suppress(OSError):
                    grow()
            while True:
                os.write(fd, b"x" * 65_536)
