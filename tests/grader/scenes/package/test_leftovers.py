"""What a step leaves running is ended, and nothing else."""

from __future__ import annotations

import subprocess
import sys

PROGRAM = """
import os, signal, sys, time
from grader.scenes.package.examining import leftovers

def born():
    reads, writes = os.pipe()
    if os.fork() == 0:
        os.setsid()
        if os.fork():
            os._exit(0)
        if os.fork():
            os.write(writes, b"%d\\n" % os.getpid())
        else:
            os.write(writes, b"%d\\n" % os.getpid())
        while True:
            time.sleep(100)
    os.wait()
    told = b""
    while told.count(b"\\n") < 2:
        told += os.read(reads, 100)
    return [int(each) for each in told.split()]

def is_there(process):
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    return True

before = born()
leftovers.end()  # nobody was adopted: these are somebody else's
assert all(map(is_there, before)), "ended what was not its own"
leftovers.adopt()
ours = born()
leftovers.end()
assert not any(map(is_there, ours)), "something is left"
leftovers.end()
for each in before:
    os.kill(each, signal.SIGKILL)
print("good")
"""


def test_what_was_started_before_goes_on_and_what_is_left_below_is_ended():
    ended = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True)
    assert (ended.stdout, ended.stderr) == ("good\n", "")
