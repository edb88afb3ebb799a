"""Several workers at once on this machine.

One that dies takes nothing with it: its task goes to a new one, once more, and is then told as
failed. So does the task of one that cannot confine it now, or not as asked.
"""

from __future__ import annotations

import queue
import signal
import subprocess
import sys
import threading
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path

from grader.batch.task import Answer, Task
from grader.language.phrase import say

#: No task takes longer, unless the grader hangs [s].
MOST_S = 3600.0
_TRIES = 2
#: -P: no module of the current folder, where anything may lie.
_COMMAND = (
    *("-P", "-c"),
    "import sys; sys.argv[1] in sys.path or sys.path.insert(0, sys.argv[1]); "
    "from grader.batch import worker; worker.main()",
    str(Path(__file__).parents[2]),
)

Done = tuple[Task, Answer]


def work(tasks: Iterable[Task], jobs: int, patience_s: float = MOST_S) -> Iterator[Done]:
    """Do tasks, each in one of `jobs` processes; yields each as soon as it is over.

    A task is taken from the iterable when a process is free. The processes end with the iterator.
    """
    waiting = _Waiting(tasks)
    over: queue.SimpleQueue[Done | BaseException | None] = queue.SimpleQueue()
    workers = [_Worker(waiting, over, patience_s) for _ in range(jobs)]
    try:
        for worker in workers:
            worker.start()
        working = len(workers)
        while working:
            done = over.get()
            if isinstance(done, BaseException):
                raise done
            if done is None:
                working -= 1
            else:
                yield done
    finally:
        for worker in workers:
            worker.stop()
        for worker in workers:
            worker.join()


class _Waiting:
    """Tasks that several threads take."""

    def __init__(self, tasks: Iterable[Task]) -> None:
        self._tasks = iter(tasks)
        self._lock = threading.Lock()

    def take(self) -> Task | None:
        """The next one."""
        with self._lock:
            return next(self._tasks, None)


class _Worker(threading.Thread):
    """A process, and who waits for its answers."""

    def __init__(
        self,
        waiting: _Waiting,
        over: queue.SimpleQueue[Done | BaseException | None],
        patience_s: float,
    ) -> None:
        super().__init__(daemon=True)
        self._waiting, self._over = waiting, over
        self._process = Process(patience_s)

    def run(self) -> None:
        try:
            while not self._process.is_over and (task := self._waiting.take()) is not None:
                self._over.put((task, self._process.done(task)))
        except BaseException as error:  # in whoever makes tasks: for the thread that waits
            self._over.put(error)
        finally:
            self._process.end()
            self._over.put(None)

    def stop(self) -> None:
        """End it, and whatever it does."""
        self._process.stop()


class Process:
    """A worker, started when it is first asked and, if it has ended since, once more.

    It ends with this process, and with this object.
    """

    def __init__(self, patience_s: float = MOST_S) -> None:
        self._patience_s = patience_s
        self._process: subprocess.Popen[bytes] | None = None
        self._lock = threading.Lock()
        self.is_over = False

    def stop(self) -> None:
        """End it, whatever it does, for good; any thread may."""
        with self._lock:
            self.is_over = True
            if self._process is not None:
                self._process.kill()

    def done(self, task: Task) -> Answer:
        """Have a task done; whatever becomes of the process is an answer."""
        ended = ""
        answer = None
        for _ in range(_TRIES):
            if self.is_over:
                break
            line = self._ask(task)
            answer = None
            with suppress(ValueError):
                answer = Answer.from_line(line)
                if answer.state not in ("again", "unfit"):
                    return answer
            ended = self.end()
        if answer is not None:
            return answer
        return Answer(
            "failed",
            say("the process that graded it ended ({how}), {times} times", how=ended, times=_TRIES),
        )

    def _ask(self, task: Task) -> bytes:
        """The line that the process answers; empty if it ends instead."""
        with self._lock:
            if self._process is None and not self.is_over:
                self._process = start()
        process = self._process
        if process is None or process.stdin is None or process.stdout is None:
            return b""
        patience = threading.Timer(self._patience_s, process.kill)
        patience.daemon = True
        patience.start()
        try:
            with suppress(OSError):
                process.stdin.write(task.to_line())
                process.stdin.flush()
                return process.stdout.readline()
            return b""
        finally:
            patience.cancel()

    def end(self) -> str:
        """Have it gone; how it ended."""
        with self._lock:
            process, self._process = self._process, None
        if process is None:
            return ""
        for pipe in (process.stdin, process.stdout):
            if pipe is not None:
                with suppress(OSError):
                    pipe.close()
        if process.poll() is None and not self.is_over:
            with suppress(subprocess.TimeoutExpired):
                process.wait(10.0)  # it ends by itself where nobody asks any more
        process.kill()
        code = process.wait()
        return signal.Signals(-code).name if code < 0 else say("exit code {code}", code=str(code))


def start() -> subprocess.Popen[bytes]:
    """Start a worker with our own modules; Ctrl-C in a terminal is not for it."""
    return subprocess.Popen(
        [sys.executable, *_COMMAND],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        start_new_session=True,
    )
