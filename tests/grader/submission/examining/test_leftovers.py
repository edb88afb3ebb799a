"""What a step leaves running is ended, and nothing else."""

import subprocess
import sys

import pytest

BEGIN = """
import ctypes, os, signal, sys, threading, time
from grader.system import linux
from grader.submission.examining import leftovers

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
"""
ONLY_ITS_OWN = """
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
"""
# /proc was listed before the last one was born, and its parent read when that was over
BORN_WHILE_LOOKED = """
leftovers.adopt()
ours = born()
look, seen = linux.descendants, []
def too_early(process):
    found = look(process)
    if len(seen) < 2:
        del found[ours[-1]]
    seen.append(found)
    return found
linux.descendants = too_early
leftovers.end()
assert not any(map(is_there, ours)), "something is left"
"""
# /proc tells of it what it tells of those that are over
WITHOUT_ITS_FIRST_THREAD = """
leftovers.adopt()
ours = born()
child = os.fork()
if child == 0:
    threading.Thread(target=time.sleep, args=(1000,)).start()
    ctypes.CDLL(None).pthread_exit(None)
while open(f"/proc/{child}/stat").read().rpartition(")")[2].split()[0] != "Z":
    time.sleep(0.001)
leftovers.end()
assert not any(map(is_there, [*ours, child])), "something is left"
"""
# as at `landlock`, where no process may list /proc
UNSEEN = """
leftovers._is_seen = lambda: False
assert leftovers.used() == (0, True)
"""


@pytest.mark.timeout(30)
@pytest.mark.parametrize(
    "program",
    [
        pytest.param(ONLY_ITS_OWN, id="only_its_own"),
        pytest.param(BORN_WHILE_LOOKED, id="born_while_looked"),
        pytest.param(WITHOUT_ITS_FIRST_THREAD, id="without_its_first_thread"),
        pytest.param(UNSEEN + ONLY_ITS_OWN, id="only_its_own, unseen"),
        pytest.param(UNSEEN + WITHOUT_ITS_FIRST_THREAD, id="without_its_first_thread, unseen"),
    ],
)
def test_what_was_started_before_goes_on_and_what_is_left_below_is_ended(program):
    ended = subprocess.run(
        [sys.executable, "-c", f"{BEGIN}{program}print('good')"], capture_output=True, text=True
    )
    assert (ended.stdout, ended.stderr) == ("good\n", "")
