"""The process that reads what was handed in, from the grader's side.

Each submission is read by a fork of it, which has limits of memory and time (`limits.py`), so that
no submission can make the grader's own process large, slow or dead, or reach the next one. It says
where it is as it goes, and at last one answer (`answer.py`). Starting the process takes 70 ms of a
core, a fork 5: it waits for the next submission, and whoever knows that one will come can have it
started before (`warm`).
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
from grader.submission.set_ups import NotInspected
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
_SHORT_OF_MEMORY: Final = "SIGKILL"
#: What was too much, by how the process has ended.
_TOO_MUCH: Final = {
    "SIGXCPU": say("that takes more than {cpu_s} s of a processor's time", cpu_s=limits.CPU_S),
    answer.TOO_LATE: say("that takes more than {wall_s} s", wall_s=limits.WALL_S),
    _SHORT_OF_MEMORY: say(
        "that takes more than {memory_bytes:.0f} MB of memory",
        memory_bytes=limits.MEMORY_BYTES / 1e6,
    ),
    **dict.fromkeys(
        ("SIGSEGV", "SIGBUS", "SIGABRT"), say("Python's own parser breaks down over it")
    ),
}

#: Those that wait to be asked; as many as were asked at the same time.
_idle: list[_Process] = []
_lock = threading.Lock()


def warm() -> None:
    """Start a process for the next submission, if none is waiting; it goes with this process."""
    with _lock:
        if not _idle:
            _idle.append(_Process())


def read(
    path: Path,
    executable: str | None,
    scratch: Path,
    *,
    is_started: bool = True,
    usual: str = USUAL_NAME,
    again: tuple[NotInspected, bytes] | None = None,
) -> Submission:
    """Read a submission; see `finding.find`, or `whole.find` for one that is not started.

    Args:
        again: what the first reading asked for, and what the inspection has answered.

    Raises:
        NotInspected: it is a package; read it again, with what an inspection says.
        SubmissionError: as there, or it takes more than the limits.
        UsageError, OSError: as there.
        GraderFailure: the process has failed.
    """
    at, last, end = _asked(
        {
            "cwd": str(Path.cwd()),
            "path": str(path),
            "executable": executable,
            "scratch": str(scratch),
            "is_started": is_started,
            "usual": usual,
            "inspected": None,
            **({} if again is None else _told(*again)),
        }
    )
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


def _told(asked: NotInspected, said: bytes) -> dict[str, object]:
    return {"base": str(asked.base), "inside": asked.inside, "inspected": said.decode("ascii")}


def _asked(request: dict[str, object]) -> tuple[str, bytes, str]:
    """Where the reading was at last, the last line that it said, and how it ended."""
    with _lock:
        process = _idle.pop() if _idle else None
    if process is not None and not process.is_there:
        process.close()
        process = None
    process = process or _Process()
    try:
        answered = process.ask(request)
    except BaseException:
        process.close()
        raise
    with _lock:
        _idle.append(process)
    return answered


class _Process:
    """A process that reads, or has others of its kind do so."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(
            [sys.executable, *_COMMAND],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env={name: os.environ[name] for name in _ENVIRONMENT if name in os.environ},
            start_new_session=True,  # Ctrl-C is for the grader, which ends all of them
        )

    @property
    def is_there(self) -> bool:
        """Whether it can be asked."""
        return self._process.poll() is None

    def close(self) -> None:
        """End it, and what it has forked."""
        with contextlib.suppress(OSError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.kill()
        self._process.wait()
        self.hang_up()

    def hang_up(self) -> None:
        """Let go of it: it ends when nobody holds its standard input any more."""
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                with contextlib.suppress(OSError):
                    pipe.close()

    def ask(self, request: dict[str, object]) -> tuple[str, bytes, str]:
        """Where the reading was at last, the last line that it said, and how it ended."""
        asks, answers = self._process.stdin, self._process.stdout
        assert asks is not None
        assert answers is not None
        with contextlib.suppress(OSError):  # it is gone; how it ended tells why
            asks.write(json.dumps(request).encode() + b"\n")
            asks.flush()
        at, last = answers.readline(), answers.readline()
        if not last:
            return "", at, answer.end(self._process.wait())
        how = json.loads(at)
        return how["at"], last, how["end"]


def _place(at: str) -> str:
    """How far it got: a name of the submission's, which comes as a string in JSON."""
    with contextlib.suppress(ValueError):
        return say(" (it got as far as {place})", place=shown(str(strict_json.loads(at))))
    return ""


@atexit.register
def close() -> None:
    """End those that wait; the next submission has another started."""
    with _lock:
        while _idle:
            _idle.pop().close()


def _leave_to_parent() -> None:
    """In a fork of this process: they are its parent's."""
    global _lock
    _lock = threading.Lock()
    for process in _idle:
        process.hang_up()
        process._process.returncode = 0  # nothing is to wait for it here
    _idle.clear()


os.register_at_fork(after_in_child=_leave_to_parent)
