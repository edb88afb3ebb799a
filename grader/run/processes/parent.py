"""A process that goes with the one that started it."""

from __future__ import annotations

import ctypes
import signal
from contextlib import suppress

#: Linux's number for this option of prctl.
PR_SET_PDEATHSIG = 1


def die_with_parent() -> None:
    """If whoever started us is killed, we go too; where the system can tell nobody, later.

    The line to the grader then ends, which is noticed with the next tick.
    """
    with suppress(AttributeError, OSError, TypeError):  # Linux only; without libc a TypeError
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
