"""Goes into what lies behind its descriptors, from there up and out, and stays in such a place."""

import os

import known
from tools import attempt, reads

CANARIES = (f"{known.HOME}/notes.txt", known.NEIGHBOUR)
for number in range(64):
    with attempt():
        os.chdir(f"/proc/self/fd/{number}")
        for path in CANARIES:
            reads("../" * 12 + path.lstrip("/"), f"read from descriptor {number}")
for number in ("self/cwd", "self/root", "self/fd", "self/task", "1/cwd", "1/root", "1/fd"):
    with attempt():
        os.chdir(f"/proc/{number}")
        for path in CANARIES:
            reads("../" * 12 + path.lstrip("/"), f"read from /proc/{number}")
            reads("root" + path, f"read from /proc/{number}/root")
os.chdir("/proc/self/fd")
from tools import drive  # noqa: E402, from a folder that is there no more

drive()
