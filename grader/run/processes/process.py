"""A process as the grader holds it, however it was started.

Its end is waited for and not asked for again and again, where the system has a descriptor for that.
"""

from __future__ import annotations

import os
import select
import subprocess
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO, Protocol


class Process(Protocol):
    """A process in a session of its own.

    Attributes:
        pid: its process id, which is also that of its group.
        stdout: the reading end of what it prints on both outputs.
        was_lost: it ended because a process of ours did, and nobody knows how it would have ended.
    """

    pid: int
    stdout: BinaryIO
    was_lost: bool

    def poll(self) -> int | None:
        """The exit code, negative for a signal, or None while it runs."""

    def wait(self, timeout_s: float) -> int | None:
        """Wait for its end; None if it still runs then."""

    def kill(self) -> None:
        """Send it SIGKILL, if it still runs."""

    def terminate(self) -> None:
        """Send it SIGTERM, if it still runs."""


class Spawned:
    """A program that was started; a `Process`."""

    was_lost = False

    def __init__(
        self,
        command: Sequence[str],
        env: Mapping[str, str],
        cwd: Path | None = None,
        pass_fds: tuple[int, ...] = (),
    ) -> None:
        self._popen = subprocess.Popen(
            command,
            env=env,
            cwd=cwd,
            pass_fds=pass_fds,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        assert self._popen.stdout is not None
        self.pid = self._popen.pid
        self.stdout: BinaryIO = self._popen.stdout  # type: ignore[assignment]
        self.poll = self._popen.poll
        self.kill, self.terminate = self._popen.kill, self._popen.terminate

    def wait(self, timeout_s: float) -> int | None:
        """Wait for its end; None if it still runs then."""
        if self.poll() is not None or await_end(self.pid, timeout_s):
            return self.poll()
        with suppress(subprocess.TimeoutExpired):
            return self._popen.wait(timeout_s)
        return None


def await_end(pid: int, timeout_s: float) -> bool:
    """Wait for the end of a child of ours; False where the system cannot.

    `subprocess` would ask again and again, with pauses of up to 50 ms.
    """
    try:
        pidfd = os.pidfd_open(pid)
    except (AttributeError, OSError):
        return False
    try:
        await_readable(pidfd, timeout_s)
    finally:
        os.close(pidfd)
    return True


def await_readable(descriptor: int, timeout_s: float) -> bool:
    """Whether there is something to read, or its other end is closed, within so long."""
    poll = select.poll()
    poll.register(descriptor, select.POLLIN)
    return bool(poll.poll(max(0, round(timeout_s * 1000))))
