"""Looks at every other process: command line, folder, open files."""

import os

from tools import achieved, attempt, command_line, processes

for pid in processes():
    line = command_line(pid)
    if any(word in line for word in (b"bystander", b"--exercise", b"simulator")):
        achieved("saw a process", line)
    for name in ("cwd", "root", "exe"):
        with attempt():
            target = os.readlink(f"/proc/{pid}/{name}")
            if name == "cwd" and "class" in target:
                achieved("saw where a process is", target)
    with attempt():
        for fd in os.listdir(f"/proc/{pid}/fd"):
            target = os.readlink(f"/proc/{pid}/fd/{fd}")
            if "recording" in target or "class" in target:
                achieved("saw a file of a process", target)
