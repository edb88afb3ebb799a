"""Leaves files, folders without rights, shared memory and queues wherever it may."""

import os
import tempfile

import known
from tools import attempt, call, creates

for place in (
    tempfile.gettempdir(),
    "/tmp",
    "/var/tmp",
    "/dev/shm",
    "/run",
    known.TEMP,
    os.getcwd(),
    "/",
):
    creates(f"{place}/attack-left", None)
    with attempt():
        os.makedirs(f"{place}/attack-folder/inner")
        os.chmod(f"{place}/attack-folder", 0)
with attempt():
    call(29, 0x5EC2, 4096, 0o1666)  # shmget
    call(64, 0x5EC2, 1, 0o1666)  # semget
    call(68, 0x5EC2, 0o1666)  # msgget
with attempt():
    call(240, b"attack-queue\0", 0o102, 0o666, 0)  # mq_open
