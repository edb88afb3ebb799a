"""A pool of worker processes on this machine, each of which grades one task after another.

A task is a line of JSON on a worker's standard input, its answer a line from its original standard
output. A worker ends when its standard input closes, in the middle of a task too: when the grader
is killed, nothing goes on working. When a worker dies, its task is given to a new one, once, and
fails if that dies too. So does the task of a worker that cannot confine it now, or not as asked.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from grader.recording import Clock
from grader.submission import LaunchAsked
from grader.system import strict_json
from grader.text import NOTHING, Message, msg, translations
from grader_class.entry import HandIn


@dataclass(frozen=True)
class Task:
    """A submission to run, and to judge for each who handed it in.

    Attributes:
        key: of the run; see `grader_class.store`.
        hand_ins: those with this content; their paths are not serialised.
        exercise: its name or path.
        time: the clock of the submission.
        seed: chooses where the varied runs start; None: the exercise's own.
        run: the folder of the run, if there is one; one that cannot be read is made anew.
        path: the submission; None where its run is only judged again.
        filename: the name that it is graded by; '' for that of `path`.
        into: an empty folder for the files; see `grader_class.store`.
        judge_only: whether to write results alone: no pages, no pictures.
        isolation: the level at which it is run, of `grader.run.processes.levels`; '': the best.
        language: of the pages.
        hides_seed: whether recordings leave out the seed.
        executable, launch: what is started; see `grader.submission.request.Request`.
    """

    key: str
    hand_ins: tuple[HandIn, ...]
    exercise: str
    time: Clock
    seed: int | None
    run: Path | None
    path: Path | None = None
    filename: str = ""
    into: Path = Path()
    judge_only: bool = False
    isolation: str = ""
    language: str = field(default_factory=translations.current)
    hides_seed: bool = False
    executable: str | None = None
    launch: LaunchAsked | None = None


Ending = Literal["done", "failed", "exercise", "again", "unfit"]


@dataclass(frozen=True)
class Answer:
    """How a task ended.

    Attributes:
        state: "done": everything is in its folder. "failed": the grader failed; "exercise": the
            exercise's code failed; "again": it failed now, but may work the next time; "unfit": the
            worker cannot confine submissions as the task asks.
        message: why.
    """

    state: Ending
    message: Message = NOTHING

    @property
    def why(self) -> Message:
        """Why it is not done, as a sentence for people."""
        if self.state == "exercise":
            return msg("The exercise's own code failed: {why}", why=self.message)
        return self.message


#: No task takes longer, unless the grader hangs [s].
MOST_S = 3600.0
_TRIES = 2
#: -P: no module of the current folder, where anything may lie.
_COMMAND = (
    *("-P", "-c"),
    "import sys; sys.argv[1] in sys.path or sys.path.insert(0, sys.argv[1]); "
    "from grader_class import grade; grade.serve()",
    str(Path(__file__).parents[1]),
)

#: Memory that is free goes back to the system: pictures and messages of several runs at once would
#: else keep a third more, each in a place of its own.
_MEMORY = {"MALLOC_ARENA_MAX": "1", "MALLOC_MMAP_THRESHOLD_": "131072"}

Done = tuple[Task, Answer]


def work(tasks: Iterable[Task], jobs: int, patience_s: float = MOST_S) -> Iterator[Done]:
    """Do tasks, each in one of `jobs` processes; yield each as soon as it is over.

    The next task is drawn from the iterable when a process is free. The processes end with the
    iterator.
    """
    waiting = iter(tasks)
    processes = [Process(patience_s) for _ in range(jobs)]
    idle = list(processes)
    running: dict[Future[Answer], tuple[Task, Process]] = {}
    over: list[Done] = []
    try:
        with ThreadPoolExecutor(jobs) as threads:
            try:
                while True:
                    while idle and (task := next(waiting, None)) is not None:
                        process = idle.pop()
                        running[threads.submit(process.done, task)] = task, process
                    yield from over
                    if not running:
                        return
                    over = []
                    for future in wait(running, return_when=FIRST_COMPLETED).done:
                        task, process = running.pop(future)
                        idle.append(process)
                        over.append((task, future.result()))
            finally:
                if running:
                    for process in processes:
                        process.stop()
    finally:
        for process in processes:
            process.end()


class Process:
    """A worker process, started with its first task, and again if it has ended since.

    It ends with this process, and with this object.
    """

    def __init__(self, patience_s: float = MOST_S) -> None:
        self._patience_s = patience_s
        self._process: subprocess.Popen[bytes] | None = None
        self._lock = threading.Lock()
        self.is_over = False

    def stop(self) -> None:
        """Kill it for good, also from another thread."""
        with self._lock:
            self.is_over = True
            if self._process is not None:
                self._process.kill()

    def done(self, task: Task) -> Answer:
        """Have a task done, and return how it ended; the death of the process is an answer too."""
        ended: str | Message = ""
        answer = None
        for _ in range(_TRIES):
            if self.is_over:
                break
            line = self._ask(task)
            answer = None
            with suppress(ValueError):
                answer = strict_json.of_line(Answer, line)
                if answer.state not in ("again", "unfit"):
                    return answer
            ended = self.end()
        if answer is not None:
            return answer
        return Answer(
            "failed",
            msg("the process that graded it ended ({how}), {times} times", how=ended, times=_TRIES),
        )

    def _ask(self, task: Task) -> bytes:
        """Return the line that the process answers; empty if it ends instead."""
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
                process.stdin.write(strict_json.line(task))
                process.stdin.flush()
                return process.stdout.readline()
            return b""
        finally:
            patience.cancel()

    def end(self) -> str | Message:
        """End the process, and return how it ended."""
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
                process.wait(10.0)  # it ends by itself when its input is closed
        process.kill()
        code = process.wait()
        if code < 0:
            return signal.Signals(-code).name
        return msg("exit code {code}", code=str(code))


def start() -> subprocess.Popen[bytes]:
    """Start a worker with the modules of this grader; Ctrl-C in a terminal does not reach it."""
    return subprocess.Popen(
        [sys.executable, *_COMMAND],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env=os.environ | _MEMORY,
        start_new_session=True,
    )
