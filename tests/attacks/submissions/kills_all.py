"""Sends the last signal to every process that it may signal."""

import os
import signal

import known
from tools import libc

for number in (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGUSR1, signal.SIGKILL):
    libc.kill(-1, int(number))
libc.kill(known.BYSTANDER, 9)
libc.kill(os.getppid(), 9)
