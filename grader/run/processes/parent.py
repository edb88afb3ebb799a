"""A process that goes with the one that started it."""

from __future__ import annotations

import ctypes
import signal

#: Linux's number for this option of prctl.
PR_SET_PDEATHSIG = 1


def die_with_parent() -> None:
    """If whoever started us is killed, we go too."""
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)
