"""Stops its own process, for good."""

from tools import libc

libc.kill(libc.getpid(), 19)
