"""Programs of this checkout as processes: started, listened to, ended."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import IO, Any, Self

ROOT = Path(__file__).resolve().parents[1]
#: Only a failing test waits so long [s].
DEADLINE_S = 90.0
#: Those that run now, in the order of their starts.
_running: list[Program] = []


def last_lines() -> str:
    """What the programs that run now have written last: for a wait that was in vain."""
    return "\n".join(
        f"{program.process.args}, exit code {program.process.poll()}, its last lines:\n"
        + "".join(program.lines[-20:])
        for program in _running
    )


def ran(command: Iterable[object], **options: Any) -> subprocess.CompletedProcess[str]:
    """A program that has ended, with what it has said."""
    return subprocess.run([*map(str, command)], capture_output=True, text=True, **options)


class Program:
    """`python -m MODULE ARGUMENTS`; what it writes to stderr is collected line by line."""

    def __init__(self, module: str, *arguments: str, **options: Any) -> None:
        path = f"{ROOT}{os.pathsep}{os.environ.get('PYTHONPATH', '')}"
        self.process = subprocess.Popen(
            [sys.executable, "-m", module, *arguments],
            cwd=options.pop("cwd", ROOT),
            env={**os.environ, "PYTHONPATH": path, "PYTHONUNBUFFERED": "1"},
            stdout=options.pop("stdout", subprocess.PIPE),
            stderr=subprocess.PIPE,
            text=True,
            **options,
        )
        _running.append(self)
        self.lines: list[str] = []
        self._news = threading.Condition()
        self._reader = threading.Thread(target=self._read, args=(self.process.stderr,))
        self._reader.start()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        """End it, so that it takes leave: others know for 20 s more of a node that is killed."""
        with suppress(ValueError):
            _running.remove(self)
        with suppress(subprocess.TimeoutExpired):
            if self.process.poll() is None:
                self.process.send_signal(signal.SIGINT)
                self.process.wait(DEADLINE_S)
        self.process.kill()
        self.process.wait()
        self._reader.join()
        for stream in (self.process.stdout, self.process.stderr):
            if stream is not None:
                stream.close()

    def wait_for_line(self, text: str, after: int = 0) -> str:
        """Wait for a line on stderr that contains `text`, from line number `after` on."""
        with self._news:
            found = self._news.wait_for(
                lambda: next((line for line in self.lines[after:] if text in line), None),
                DEADLINE_S,
            )
        assert found, f"no line with {text!r} in {DEADLINE_S} s; there are:\n" + self.text()
        return found

    def wait(self) -> int:
        code = self.process.wait(DEADLINE_S)
        self._reader.join()
        return code

    def stop(self, how: signal.Signals = signal.SIGINT) -> int:
        """Ask it to end; the exit code."""
        self.process.send_signal(how)
        return self.wait()

    def text(self) -> str:
        """All that it has written to stderr."""
        return "".join(self.lines)

    def _read(self, stream: IO[str]) -> None:
        for line in stream:
            with self._news:
                self.lines.append(line)
                self._news.notify_all()
