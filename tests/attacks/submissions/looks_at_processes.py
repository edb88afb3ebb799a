"""Looks at every other process: command line, folder, files, memory."""

import os

from tools import achieved, attempt, command_line, processes, reads

for pid in processes():
    line = command_line(pid)
    if b"grader" in line or b"bystander" in line:
        achieved("saw a process", line)
    for name in ("cwd", "root", "exe"):
        with attempt():
            target = os.readlink(f"/proc/{pid}/{name}")
            if name == "cwd" and "class" in target:
                achieved("saw where a process is", target)
    reads(f"/proc/{pid}/root/etc/hostname", None) if False else None
    with attempt():
        for fd in os.listdir(f"/proc/{pid}/fd"):
            target = os.readlink(f"/proc/{pid}/fd/{fd}")
            if "memfd:" in target or "class" in target:
                achieved("saw a file of a process", target)
