"""A dask cluster on this machine: a scheduler, and workers that share nothing with us but it."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Self, TypeVar

import psutil

from tests.grader.batch.classes import DEADLINE_S, ENV, ROOT

Found = TypeVar("Found")


class Cluster:
    """Processes that are killed at its end; each begins with nothing of the others."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.address = ""
        self._processes: list[subprocess.Popen[bytes]] = []
        self._held: list[psutil.Process] = []

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for process in self._processes:
            kill(process)
        for grading in self._held:  # what is stopped does not see that nobody is there any more
            with suppress(psutil.NoSuchProcess):
                grading.kill()

    def start_scheduler(self, **env: str) -> subprocess.Popen[bytes]:
        """Start one, at the address of the one before; returns when it listens."""
        file = self.folder / "scheduler.json"
        file.unlink(missing_ok=True)
        port = self.address.rpartition(":")[2] or "0"
        where = ["--host", "127.0.0.1", "--port", port, "--scheduler-file", str(file)]
        process = self._start("scheduler", "--no-dashboard", "--no-show", *where, **env)
        self.address = until(lambda: _address(file))
        return process

    def start_worker(self, refused: str = "", **env: str) -> subprocess.Popen[bytes]:
        """Start one that grades one at a time; it ends if its scheduler does.

        Args:
            refused: what its system refuses; see `tests/refusing.py`.
        """
        one = ["--nthreads", "1", "--no-nanny", "--no-dashboard", "--host", "127.0.0.1"]
        scratch = ["--local-directory", str(self.folder)]
        before = [sys.executable, str(ROOT / "tests" / "refusing.py"), refused] if refused else []
        words = (self.address, *one, *scratch)
        return self._start("worker", *words, before=before, **env)

    def held(self, worker: subprocess.Popen[bytes]) -> psutil.Process:
        """The process that does a worker's task, as soon as there is one, stopped in the middle."""

        def grades(child: psutil.Process) -> bool:  # others come and go while a worker starts
            with suppress(psutil.Error):
                return any("grader.batch" in word for word in child.cmdline())
            return False

        def look() -> psutil.Process | None:
            return next(filter(grades, psutil.Process(worker.pid).children()), None)

        grading: psutil.Process = until(look)
        grading.suspend()
        self._held.append(grading)
        return grading

    def _start(
        self, what: str, *words: str, before: Sequence[str] = (), **env: str
    ) -> subprocess.Popen[bytes]:
        with (self.folder / f"{len(self._processes)}.{what}.log").open("wb") as log:
            process = subprocess.Popen(
                [*before, sys.executable, "-P", "-m", f"distributed.cli.dask_{what}", *words],
                env={**ENV, "DASK_TEMPORARY_DIRECTORY": str(self.folder), **env},
                cwd=self.folder,
                stdout=log,
                stderr=log,
            )
        self._processes.append(process)
        return process


class Call:
    """`grader batch` while it goes on."""

    def __init__(self, command: list[str], folder: Path) -> None:
        self._said = folder / "said.txt"
        with self._said.open("wb") as said:
            self.process = subprocess.Popen(command, env=ENV, stderr=said)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        kill(self.process)

    def text(self) -> str:
        """What it has said."""
        return self._said.read_text(encoding="utf-8")

    def wait_for(self, words: str) -> None:
        """Wait until it has said something."""
        until(lambda: words in self.text() or self.process.poll() is not None)
        said = self.text()
        assert words in said, said

    def wait(self) -> int:
        """Wait for its end; the exit code."""
        return self.process.wait(DEADLINE_S)


def kill(process: subprocess.Popen[Any]) -> None:
    """End it as power does."""
    process.kill()
    process.wait()


def until(look: Callable[[], Found | None]) -> Found:
    """What there is, as soon as there is something."""
    deadline = time.monotonic() + DEADLINE_S
    while not (found := look()):
        assert time.monotonic() < deadline, "it never came"
        time.sleep(0.02)
    return found


def _address(file: Path) -> str:
    if not file.exists():
        return ""
    try:
        return str(json.loads(file.read_text())["address"])
    except ValueError:  # it is being written
        return ""
