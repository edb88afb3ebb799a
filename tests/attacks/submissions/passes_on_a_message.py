"""Leaves a message wherever it may, and looks for one that an earlier run, or grading, has left."""

import glob
import mmap
import os
import tempfile
from multiprocessing import shared_memory

import known
from tools import achieved, attempt, call, libc

NAME = "attack-message"
PLACES = (tempfile.gettempdir(), "/tmp", "/var/tmp", "/dev/shm", "/run", known.TEMP, os.getcwd())
MQ_OPEN, SHMGET, SEMGET, MSGGET, MEMFD_CREATE, KEY = 240, 29, 64, 68, 319, 0x5EC3

for place in PLACES:
    for path in glob.glob(f"{place}/**/{NAME}", recursive=True):
        achieved("a file of an earlier run", path)
with attempt("shared memory of an earlier run"):
    shared_memory.SharedMemory(NAME)
with attempt("a semaphore of an earlier run"):
    assert libc.sem_open(f"/{NAME}".encode(), 0) != 0
for what, number, words in (
    ("a queue", MQ_OPEN, (NAME.encode() + b"\0", 0)),
    ("SysV shared memory", SHMGET, (KEY, 4096, 0)),
    ("SysV semaphores", SEMGET, (KEY, 1, 0)),
    ("a SysV queue", MSGGET, (KEY, 0)),
):
    if call(number, *words)[0] >= 0:
        achieved(f"{what} of an earlier run")

for place in PLACES:
    with attempt(), open(f"{place}/{NAME}", "w") as file:
        file.write("attacked")
with attempt():
    kept = shared_memory.SharedMemory(NAME, create=True, size=mmap.PAGESIZE)
with attempt():
    libc.sem_open(f"/{NAME}".encode(), os.O_CREAT, 0o666, 1)
call(MQ_OPEN, NAME.encode() + b"\0", 0o102, 0o666, 0)
call(SHMGET, KEY, 4096, 0o1666)
call(SEMGET, KEY, 1, 0o1666)
call(MSGGET, KEY, 0o1666)
os._exit(0)  # nothing tidies up
