"""Kills processes one by one, by number: parents first."""

import os

import known
from tools import achieved, libc, processes

mine = os.getpid()
for pid in [known.BYSTANDER, os.getppid(), *processes(), *range(1, 2000)]:
    if pid not in (0, mine) and libc.kill(pid, 9) == 0 and pid != 1:
        achieved("killed", pid) if pid == known.BYSTANDER else None
libc.kill(0, 9)
