"""Looks for tokens: in its own environment, in the memory that it was started with, in others'."""

import ctypes
import os

from tools import achieved, attempt, libc, processes, reads

achieved("environment", dict(os.environ))
for name in ("GITHUB_TOKEN", "AWS_SECRET_ACCESS_KEY", "COURSE_TOKEN", "CI_JOB_TOKEN"):
    libc.getenv.restype = ctypes.c_char_p
    achieved("getenv", libc.getenv(name.encode()))
for pid in ["self", "thread-self", *processes()]:
    reads(f"/proc/{pid}/environ", "environment")  # what is in it is looked for
WORD = b"-".join((b"CANARY", b"environment"))  # not in one piece: what is here is in memory too
with attempt():  # what is left on the stack, above the environment that Python knows
    with open("/proc/self/maps") as maps, open("/proc/self/mem", "rb", 0) as memory:
        for line in maps:
            if "[stack]" in line or "[heap]" in line:
                start, end = (int(word, 16) for word in line.split()[0].split("-"))
                memory.seek(start)
                pieces = memory.read(end - start).split(WORD)
                for before, after in list(zip(pieces, pieces[1:], strict=False))[:20]:
                    achieved("environment", before[-30:] + WORD + after[:30])
