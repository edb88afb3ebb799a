"""What a simulator's process does first: what it serves must not reach it, nor fill the machine."""

from __future__ import annotations

import signal

from grader.run.processes.parent import be_out_of_reach, die_with_parent, limit_memory

#: Of its own; a run takes 0.2 GB, and what may come from a submission at most as much again.
MOST_MEMORY_BYTES = 3_000_000_000


def take() -> None:
    """Take them, before anything else."""
    die_with_parent()
    be_out_of_reach()
    limit_memory(MOST_MEMORY_BYTES)
    # Ctrl-C in a terminal reaches the whole group; the grader decides what happens then.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
