"""Who runs submissions in a container: a grader, or Python alone; each is watched meanwhile.

A grader is one process that calls the real command line for one submission after the other, as a
worker of `grader batch` does: what an attack does to it, the next one suffers. What runs where
nothing is graded belongs to it; whatever else is there after a grading was left by that.
"""

import fcntl
import json
import os
import pty
import select
import signal
import subprocess
import sys
import termios
import time
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

from tests.attacks import levels

#: So long a grading may take before it counts as one that never ends, and what it leaves may take
#: to go [s].
PATIENCE_S, LINGERS_S = 100.0, 20.0
#: Between two looks at what runs [s].
EVERY_S = 0.05
#: Reads a folder and the words of a call as JSON, a line each; answers with exit codes.
SERVES = """
import json, os, sys
asked, answers = int(sys.argv[1]), int(sys.argv[2])
for fd in asked, answers:
    os.set_inheritable(fd, False)
sys.path.insert(0, sys.argv[3])
sys.argv[:] = ["grader", *sys.argv[1:]]
from grader.cli import main
for line in os.fdopen(asked):
    folder, words = json.loads(line)
    os.chdir(folder)
    try:
        code = main(words)
    except SystemExit as end:
        code = end.code
    sys.stdout.flush()
    os.write(answers, b"%d\\n" % (code or 0))
"""


class Terminal:
    """A terminal, seen from both sides."""

    def __init__(self, uid: int, held: ExitStack) -> None:
        self._master, self.slave = pty.openpty()
        held.callback(os.close, self._master)
        held.callback(os.close, self.slave)
        self.name = os.ttyname(self.slave)
        if os.getuid() == 0:
            os.chown(self.name, uid, -1)
        os.set_blocking(self._master, False)
        raw = termios.tcgetattr(self.slave)
        raw[3] &= ~(termios.ECHO | termios.ICANON)
        termios.tcsetattr(self.slave, termios.TCSANOW, raw)

    def written(self) -> bytes:
        """What was written to it."""
        return self._read(self._master)

    def typed(self) -> bytes:
        """What was typed into it."""
        os.set_blocking(self.slave, False)
        return self._read(self.slave)

    def _read(self, fd: int) -> bytes:
        with suppress(OSError):
            return os.read(fd, 200)
        return b""


class Runner:
    """Runs submissions as a user at a level.

    Attributes:
        terminal: of all that it starts.
        apart: processes that are not its own and no submission's.
        is_spent: the next submission needs another one.
    """

    lingers_s = LINGERS_S

    def __init__(self, level: levels.Level, uid: int, env: dict[str, str]) -> None:
        self.apart: set[int] = set()
        self.is_spent = False
        self._level, self._env = level, env
        self._own: set[int] = set()
        self._held = ExitStack()
        self.terminal = Terminal(uid, self._held)
        self._streams = [os.memfd_create(name) for name in ("stdout", "stderr")]
        for fd in self._streams:
            self._held.callback(os.close, fd)

    def run(self, words: list[str], folder: Path) -> dict[str, Any]:
        """Run a submission, and end what it leaves; what was seen."""
        before = [os.fstat(fd).st_size for fd in self._streams]
        process = self._begin(words, folder)
        code, most, memory, deadline = None, 0, 0, time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline and (code := self._ended(process)) is None:
            others = self._others()
            most = max(most, len(others))
            memory = max(memory, *map(_memory, others), _memory(process.pid))
        hung = code is None
        left = [] if hung else self._left()
        if hung or left:
            self._end_all()
        return {
            "code": code,
            "hung": hung,
            "left": left,
            "said": "".join(map(_text, self._streams, before)),
            "most_processes": most,
            "most_memory": memory,
        }

    def close(self) -> list[str]:
        """Run no more; the command lines of what is left."""
        left = self._left()
        self._end_all()
        self._held.close()
        return left

    def _begin(self, words: list[str], folder: Path) -> subprocess.Popen[bytes]:
        raise NotImplementedError

    def _ended(self, process: subprocess.Popen[bytes]) -> int | None:
        """The exit code, waited for a moment; None if it still runs."""
        raise NotImplementedError

    def _start(self, command: list[str], folder: Path, *fds: int) -> subprocess.Popen[bytes]:
        def begin() -> None:
            os.setsid()
            fcntl.ioctl(0, termios.TIOCSCTTY, 0)
            levels.become(self._level)

        return subprocess.Popen(
            [sys.executable, *command],
            stdin=self.terminal.slave,
            stdout=self._streams[0],
            stderr=self._streams[1],
            cwd=folder,
            env=self._env,
            pass_fds=fds,
            preexec_fn=begin,
        )

    def _left(self) -> list[str]:
        """What is still there after a while."""
        deadline = time.monotonic() + self.lingers_s
        while (left := self._others()) and time.monotonic() < deadline:
            _reap(left)
            time.sleep(0.02)
        return [_told(pid) for pid in left]

    def _others(self) -> list[int]:
        return [pid for pid in _processes() if pid not in self.apart | self._own]

    def _end_all(self) -> None:
        self.is_spent = True
        self._own.clear()
        while others := self._others():
            for pid in others:
                with suppress(ProcessLookupError):
                    os.kill(pid, signal.SIGKILL)
            _reap(others)
            time.sleep(0.01)


class Python(Runner):
    """Python alone: nothing is graded and nothing confined."""

    lingers_s = 0.2  # what it leaves stays

    def _begin(self, words: list[str], folder: Path) -> subprocess.Popen[bytes]:
        return self._start(words, folder)

    def _ended(self, process: subprocess.Popen[bytes]) -> int | None:
        with suppress(subprocess.TimeoutExpired):
            return process.wait(EVERY_S)
        return None


class Grader(Runner):
    """The grader of a folder, as one process."""

    def __init__(
        self, level: levels.Level, uid: int, env: dict[str, str], tree: Path, folder: Path
    ) -> None:
        super().__init__(level, uid, env)
        self._is_settled = False
        asked, self._asks = os.pipe()
        self._answers, answers = os.pipe()
        words = ["-P", "-c", SERVES, str(asked), str(answers), str(tree)]
        self._process = self._start(words, folder, asked, answers)
        for fd in (asked, answers):
            os.close(fd)
        self._held.callback(os.close, self._answers)

    def close(self) -> list[str]:
        os.close(self._asks)
        if not self.is_spent:
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(self.lingers_s)
        self._own.clear()
        return super().close()

    def _left(self) -> list[str]:
        if not self._is_settled:  # what the first grading has started is for all
            self._is_settled, self._own = True, set(_processes()) - self.apart
        return super()._left()

    def _begin(self, words: list[str], folder: Path) -> subprocess.Popen[bytes]:
        os.write(self._asks, json.dumps([str(folder), words]).encode() + b"\n")
        return self._process

    def _ended(self, process: subprocess.Popen[bytes]) -> int | None:
        if not select.select([self._answers], [], [], EVERY_S)[0]:
            return None
        if answer := os.read(self._answers, 100):
            return int(answer)
        self.is_spent = True  # it has died
        return process.wait()


def _processes() -> list[int]:
    names = [each.name for each in Path("/proc").iterdir()]
    return [pid for pid in map(int, filter(str.isdigit, names)) if pid != 1]


def _memory(pid: int) -> int:
    """What of its memory is its own alone [bytes]."""
    with suppress(OSError, IndexError, ValueError):
        words = Path(f"/proc/{pid}/statm").read_text().split()
        return (int(words[1]) - int(words[2])) * os.sysconf("SC_PAGE_SIZE")
    return 0


def _reap(pids: list[int]) -> None:
    """Take leave of those that were left to us."""
    for pid in pids:
        with suppress(ChildProcessError):
            os.waitpid(pid, os.WNOHANG)


def _told(pid: int) -> str:
    """Its command line; of one that has ended, what is known."""
    with suppress(OSError):
        line = Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ")
        line = line or Path(f"/proc/{pid}/stat").read_bytes()[:40]
        return line.decode(errors="replace")[-120:]
    return "?"


def _text(fd: int, start: int) -> str:
    size = os.fstat(fd).st_size - start
    return os.pread(fd, min(size, 1 << 20), start).decode("utf-8", "replace")
