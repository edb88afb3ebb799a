"""Takes hold of every other process as a debugger does, and of its own parents."""

import os

from tools import achieved, call, command_line, fork, processes

SEIZE, ATTACH, POKE, TRACEME = 0x4206, 16, 5, 0
for pid in [os.getppid(), *processes()]:
    for request in (SEIZE, ATTACH):
        if call(101, request, pid, 0, 0)[0] == 0:
            achieved("traces", command_line(pid))
child = fork()
if child == 0:
    if call(101, TRACEME, 0, 0, 0)[0] == 0:
        achieved("is traced")
    os._exit(0)
os.waitpid(child, 0)
