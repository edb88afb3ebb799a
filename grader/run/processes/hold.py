"""Makes a network namespace inside a user namespace, and keeps both until its input closes.

    python -I -S hold.py

It says `ready`, or `refused` and why (`refusal`). A program of its own: only a process with a
single thread may make a user namespace.
"""

from __future__ import annotations

import os
import sys

if __name__ == "__main__":
    # on the import path, which is empty but for Python's own: where our packages are
    sys.path.append(os.path.realpath(f"{__file__}/../../../.."))

from grader import linux
from grader.run.processes.refusal import Refusal

#: Stands before the reason why there are none.
REFUSED = "refused"


def hold() -> None:
    """Make the namespaces and keep them until standard input closes."""
    user, group = os.getuid(), os.getgid()
    try:
        linux.unshare(linux.CLONE_NEWUSER | linux.CLONE_NEWNET)
        for name, text in (
            ("setgroups", "deny"),
            ("uid_map", f"0 {user} 1"),
            ("gid_map", f"0 {group} 1"),
        ):
            with open(f"/proc/self/{name}", "w", encoding="ascii") as file:  # noqa: PTH123
                file.write(text)
        linux.raise_loopback()
    except OSError as error:
        os.write(1, f"{REFUSED} {Refusal.of(error).to_line()}\n".encode("utf-8", "replace"))
        return
    os.write(1, b"ready\n")
    os.read(0, 1)


if __name__ == "__main__":
    hold()
