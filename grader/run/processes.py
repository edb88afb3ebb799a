"""Start, watch and end processes so that none is left behind."""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import threading
import uuid
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

import psutil

PR_SET_CHILD_SUBREAPER = 36
#: How much of a process's output is kept: this many bytes of its start and as many of its end.
KEEP_BYTES = 32_768
#: An environment variable that tells the processes of one run from those of others.
MARK = "TURTLESIM_GRADER_PROCESS"


def adopt_orphans() -> None:
    """Become the parent of grandchildren whose parent ends, so that they can be found."""
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1)


class Watched:
    """A process in a session of its own whose output is read as it comes.

    However much it prints, only the start and the end are kept, and it never blocks on a full pipe.
    """

    def __init__(
        self,
        command: Sequence[str],
        env: Mapping[str, str],
        cwd: Path | None = None,
        pass_fds: tuple[int, ...] = (),
    ) -> None:
        self._mark = uuid.uuid4().hex
        self._process = subprocess.Popen(
            command,
            env={**env, MARK: self._mark},
            cwd=cwd,
            pass_fds=pass_fds,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        self._head = bytearray()
        self._tail = bytearray()
        self._dropped = 0
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    @property
    def pid(self) -> int:
        """The process id."""
        return self._process.pid

    def poll(self) -> int | None:
        """The exit code, negative for a signal, or None while it runs."""
        return self._process.poll()

    def wait(self, timeout_s: float) -> int | None:
        """Wait for its end; None if it still runs then."""
        with suppress(subprocess.TimeoutExpired):
            return self._process.wait(timeout_s)
        return None

    def output(self) -> str:
        """What it has printed: all of it, or its start and end with a note between."""
        self._reader.join(1.0)  # ends with the process, unless a grandchild keeps the pipe
        middle = f"\n[... {self._dropped} bytes left out ...]\n" if self._dropped else ""
        return (
            self._head.decode("utf-8", "replace") + middle + self._tail.decode("utf-8", "replace")
        )

    def end(self, patience_s: float = 2.0) -> None:
        """Ask it to end as Ctrl-C would, then insist; its descendants go with it."""
        for sent in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            if self.poll() is None:
                with suppress(ProcessLookupError):
                    os.killpg(self.pid, sent)
                self.wait(patience_s)
        # A descendant that left the group is still below us: see adopt_orphans.
        family = [p for p in psutil.Process().children(recursive=True) if self._owns(p)]
        for process in family:
            with suppress(psutil.NoSuchProcess):
                process.kill()
        psutil.wait_procs(family, timeout=patience_s)

    def _owns(self, process: psutil.Process) -> bool:
        with suppress(psutil.Error):
            return bool(process.environ().get(MARK) == self._mark)
        return False

    def _read(self) -> None:
        assert self._process.stdout is not None
        fd = self._process.stdout.fileno()
        while chunk := os.read(fd, 65536):
            room = KEEP_BYTES - len(self._head)
            self._head += chunk[:room]
            self._tail += chunk[room:]
            if len(self._tail) > KEEP_BYTES:
                self._dropped += len(self._tail) - KEEP_BYTES
                del self._tail[:-KEEP_BYTES]

