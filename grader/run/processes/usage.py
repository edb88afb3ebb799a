"""What a process does, as Linux tells it."""

from __future__ import annotations

import os
from pathlib import Path


def cpu_s(pid: int) -> float:
    """The processor time that a process has used [s]; 0 if there is none."""
    fields = _stat(pid)
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK") if fields else 0.0


def sleeps(pid: int) -> bool:
    """Whether a process waits, without wanting the processor."""
    return _stat(pid)[:1] == ["S"]


def is_stopped(pid: int) -> bool:
    """Whether somebody has stopped a process, by SIGSTOP or as a debugger does."""
    return _stat(pid)[:1] in (["T"], ["t"])


def _stat(pid: int) -> list[str]:
    try:
        text = Path(f"/proc/{pid}/stat").read_text(encoding="ascii", errors="replace")
    except OSError:
        return []
    return text.rsplit(")", 1)[1].split()
