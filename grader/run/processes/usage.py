"""What a process does, as Linux tells it."""

from __future__ import annotations

import os
from pathlib import Path
from typing import NamedTuple


class Usage(NamedTuple):
    """A look at a process.

    Attributes:
        cpu_s: the processor time that it has used [s]; 0 if there is no such process.
        state: the kernel's letter for what it does; '' if there is no such process.
    """

    cpu_s: float
    state: str

    @property
    def sleeps(self) -> bool:
        """Whether it waits, without wanting the processor."""
        return self.state == "S"

    @property
    def is_stopped(self) -> bool:
        """Whether somebody has stopped it, by SIGSTOP or as a debugger does."""
        return self.state in ("T", "t")

    @property
    def has_ended(self) -> bool:
        """Whether there is no such process, or only its exit code."""
        return self.state in ("", "Z", "X")


def look(pid: int) -> Usage:
    """What a process has used, and does now."""
    try:
        text = Path(f"/proc/{pid}/stat").read_text(encoding="ascii", errors="replace")
    except OSError:
        return Usage(0.0, "")
    fields = text.rsplit(")", 1)[1].split()
    ticks = int(fields[11]) + int(fields[12])
    return Usage(ticks / os.sysconf("SC_CLK_TCK"), fields[0])
