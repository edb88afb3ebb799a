"""A process of ours beside a submission's: it goes with the grader, and is its own."""

from __future__ import annotations

import ctypes
import signal
from contextlib import suppress

#: Linux's numbers for options of prctl.
PR_SET_PDEATHSIG = 1
PR_SET_DUMPABLE = 4


def die_with_parent() -> None:
    """If whoever started us is killed, we go too; where the system can tell nobody, later.

    The line to the grader then ends, which is noticed with the next tick.
    """
    with suppress(AttributeError, OSError, TypeError):  # Linux only; without libc a TypeError
        ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL)


def be_out_of_reach() -> None:
    """Nobody else of the same user may look into our memory and descriptors, or trace us."""
    with suppress(AttributeError, OSError, TypeError):
        ctypes.CDLL(None).prctl(PR_SET_DUMPABLE, 0)


def limit_memory(most_bytes: int) -> None:
    """So much memory of its own may this process have; the next request for some fails."""
    with suppress(ImportError, OSError, ValueError):
        import resource  # not on Windows

        _, hard = resource.getrlimit(resource.RLIMIT_DATA)
        most = most_bytes if hard == resource.RLIM_INFINITY else min(most_bytes, hard)
        resource.setrlimit(resource.RLIMIT_DATA, (most, hard))
