"""The process that reads what was handed in, from the grader's side: asked once, then gone.

It has limits of memory and time (`limits.py`), so that no submission can make the grader's own
process large, slow or dead. It says where it is as it goes, and at last one answer (`answer.py`).
Starting it takes 50 ms of a core, so whoever knows that a submission will come can have one started
before (`warm`).
"""

from __future__ import annotations

import atexit
import contextlib
import json
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import Final

from grader import strict_json
from grader.errors import GraderFailure, SubmissionError
from grader.language.phrase import say
from grader.submission import answer, limits
from grader.submission.folder import USUAL_NAME, shown
from grader.submission.start import Submission

#: No module but Python's own and ours, nothing from the environment, no start-up code of a venv.
_COMMAND: Final = (
    *("-I", "-S", "-c"),
    "import sys; sys.path.append(sys.argv[1]); "
    "from grader.submission import reader_main; reader_main.main()",
    str(Path(__file__).parents[2]),
)
#: What Python needs to start, and to take the same bytes of a name for the same characters.
_ENVIRONMENT: Final = (
    *("LANG", "LC_ALL", "LC_CTYPE", "SYSTEMROOT"),
    *("LD_LIBRARY_PATH", "DYLD_LIBRARY_PATH"),
)
_PLAIN: Final = say("Hand in nothing but the files of your package, written plainly.")
_WAITED, _SHORT_OF_MEMORY = "SIGALRM", "SIGKILL"
#: What was too much, by how the process has ended.
_TOO_MUCH: Final = {
    "SIGXCPU": say("that takes more than {cpu_s} s of a processor's time", cpu_s=limits.CPU_S),
    _WAITED: say("that takes more than {wall_s} s", wall_s=limits.WALL_S),
    _SHORT_OF_MEMORY: say(
        "that takes more than {memory_bytes:.0f} MB of memory",
        memory_bytes=limits.MEMORY_BYTES / 1e6,
    ),
    **dict.fromkeys(
        ("SIGSEGV", "SIGBUS", "SIGABRT"), say("Python's own parser breaks down over it")
    ),
}

_warm: list[_Process] = []
_lock = threading.Lock()


def warm() -> None:
    """Start a process for the next submission, if none is waiting; it goes with this process."""
    with _lock:
        if not _warm:
            _warm.append(_Process())


def read(
    path: Path,
    executable: str | None,
    scratch: Path,
    *,
    is_started: bool = True,
    usual: str = USUAL_NAME,
) -> Submission:
    """Read a submission; see `finding.find`, or `whole.find` for one that is not started.

    Raises:
        SubmissionError: as there, or it takes more than the limits.
        UsageError, OSError: as there.
        GraderFailure: the process has failed.
    """
    with _lock:
        process = _warm.pop() if _warm else None
    if process is not None and not process.is_there:
        process.close()
        process = None
    with process or _Process() as asked:
        at, last = asked.ask(
            {
                "cwd": str(Path.cwd()),
                "path": str(path),
                "executable": executable,
                "scratch": str(scratch),
                "is_started": is_started,
                "usual": usual,
            }
        )
        end = asked.end()
    said = answer.parsed(last)
    if said is not None and not answer.is_short_of_memory(said):
        return answer.decoded(said)
    name = shown(path.name or path.resolve().name)
    if said is not None:
        end = _SHORT_OF_MEMORY
    if end not in _TOO_MUCH:
        told = shown(last.decode("utf-8", "replace").strip())
        raise GraderFailure(
            say(
                "{name} could not be read: the process for it ended ({end}): {told}",
                name=name,
                end=end,
                told=told,
            )
        )
    raise SubmissionError(
        say(
            "{name} cannot be read: {too_much}{place}. {plain}",
            name=name,
            too_much=_TOO_MUCH[end],
            place=_place(at),
            plain=_PLAIN,
        )
    )


class _Process:
    """One process that reads; a context that it does not outlive."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, *_COMMAND],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env={name: os.environ[name] for name in _ENVIRONMENT if name in os.environ},
        )
        self._was_waited_for = False

    @property
    def is_there(self) -> bool:
        """Whether it can be asked."""
        return self._process.poll() is None

    def __enter__(self) -> _Process:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End it."""
        self._process.kill()
        self._process.wait()
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                with contextlib.suppress(OSError):
                    pipe.close()

    def ask(self, request: dict[str, object]) -> tuple[str, bytes]:
        """Where it was at last, and the last line that it said."""
        pipe = self._process.stdin
        assert pipe is not None
        with contextlib.suppress(OSError):  # it is gone; what it said tells why
            pipe.write(json.dumps(request).encode() + b"\n")
            pipe.close()
        patience = threading.Timer(limits.WALL_S, self._give_up)
        patience.daemon = True
        patience.start()
        try:
            return self._listen()
        finally:
            patience.cancel()

    def _give_up(self) -> None:
        self._was_waited_for = True
        self._process.kill()

    def _listen(self) -> tuple[str, bytes]:
        """Keep of what it says only the last line, and the last place."""
        pipe = self._process.stdout
        assert pipe is not None
        at, last = "", b""
        while line := pipe.readline(answer.MAX_BYTES + 1):
            if line.startswith(answer.AT):
                at = line[len(answer.AT) :].decode("ascii", "replace").strip()
            else:
                last = line
        return at, last

    def end(self) -> str:
        """How it ended: the name of a signal, or an exit code."""
        code = self._process.wait()
        if self._was_waited_for:
            return _WAITED
        return signal.Signals(-code).name if code < 0 else str(code)


def _place(at: str) -> str:
    """How far it got: a name of the submission's, which comes as a string in JSON."""
    with contextlib.suppress(ValueError):
        return say(" (it got as far as {place})", place=shown(str(strict_json.loads(at))))
    return ""


@atexit.register
def _forget() -> None:
    """End a process that nobody has asked."""
    with _lock:
        while _warm:
            _warm.pop().close()
