"""For all tests of the grader: its command line, called in this process, leaves no trace in it."""

import ctypes
import signal

import pytest

from grader.run.processes import started_process

PR_GET_CHILD_SUBREAPER, PR_SET_CHILD_SUBREAPER = 37, 36


@pytest.fixture(autouse=True)
def as_it_was_before():
    """Restore the handlers of signals, and whether this process adopts orphans."""
    handlers = {number: signal.getsignal(number) for number in started_process.ENDING}
    libc, adopts = ctypes.CDLL(None), ctypes.c_int()
    libc.prctl(PR_GET_CHILD_SUBREAPER, ctypes.byref(adopts))
    yield
    for number, handler in handlers.items():
        signal.signal(number, handler)
    libc.prctl(PR_SET_CHILD_SUBREAPER, adopts.value)
