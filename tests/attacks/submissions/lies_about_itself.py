"""Finds the pipe on which our own code tells of this process; lies there."""

import fcntl
import json
import os
from contextlib import suppress

F_SETPIPE_SZ = 1031
HOSTILE = '<script>alert(1)</script>\x1b[31m\n::error::\u202e=HYPERLINK("x")'
PLACE = {"file": "../../../../etc/passwd", "line": 1, "function": HOSTILE, "text": HOSTILE}
LIES = (
    {"end": {"kind": "publisher", "name": HOSTILE, "type": HOSTILE, "place": PLACE}},
    {"used": [0, 2**52, True]},
    {"raised": {"type": HOSTILE, "text": HOSTILE, "time_s": 1e300, "place": PLACE}},
    {"returned": 0.0},
)
DUMP = f"""Fatal Python error: Aborted

Current thread 0x00 (most recent call first):
  File "{os.getcwd()}/../../../../etc/passwd", line 1 in {"x" * 400}
"""

for fd in range(3, 64):
    with suppress(OSError):
        if os.readlink(f"/proc/self/fd/{fd}").startswith("pipe:"):
            os.set_blocking(fd, False)
            fcntl.fcntl(fd, F_SETPIPE_SZ, 1 << 20)
            for lie in LIES:
                os.write(fd, json.dumps(lie).encode() + b"\n")
            os.write(fd, DUMP.encode())
