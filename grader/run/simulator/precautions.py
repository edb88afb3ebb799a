"""What a simulator's process does first: what it serves must not reach it, nor fill the machine."""

from __future__ import annotations

import resource
import signal

from grader import linux
from grader.run.processes.sandbox.limits import lower

#: Of its own; a run takes 0.2 GB, and what may come from a submission at most as much again.
MOST_MEMORY_BYTES = 3_000_000_000


def take() -> None:
    """Take them, before anything else."""
    linux.control(linux.PR_SET_DUMPABLE, 0)  # nobody else looks into our memory and descriptors
    lower(resource.RLIMIT_DATA, MOST_MEMORY_BYTES, resource.RLIM_INFINITY)
    # Ctrl-C in a terminal reaches the whole group; the grader decides what happens then.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
