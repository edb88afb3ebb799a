"""Reads what a submission's process reports of itself, and checks it for the recording.

Its account lies in a page that both processes have (`observe.account`), and so does the dump that
Python's faulthandler writes at a signal, or where the process dies by a fault in C. The dump is
written by C code, so it comes even where a program computes without end. The submission may have
written either: both are checked by the annotations of `Observations`, and if anything differs from
what our own code writes, nothing counts.
"""

from __future__ import annotations

import os
import re
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import fields, is_dataclass, replace
from typing import Any

from grader.recording.observations import (
    STRANGERS,
    Caught,
    LintFinding,
    Observations,
    Raised,
    RanFile,
    SourceLine,
)
from grader.run.observe import account, ending
from grader.run.observe.files import Frame, SubmissionFiles
from grader.submission.start import Submission
from grader.system import extensions, linux, strict_json

#: How long a process may take to dump where it is [s]; it has nothing else to do.
PATIENCE_S = 1.0
#: A dump comes line by line, and is over when nothing more comes for so long [s].
QUIET_S = 0.1
#: How often it is read meanwhile, and how long a busy machine may keep it waiting [s].
PERIOD_S, LONGEST_S = 0.002, 20.0
#: How a dump begins for a fault in C, and which signal ended the process then.
SIGNALS = {
    "Aborted": "SIGABRT",
    "Segmentation fault": "SIGSEGV",
    "Bus error": "SIGBUS",
    "Floating-point exception": "SIGFPE",
    "Floating point exception": "SIGFPE",
    "Illegal instruction": "SIGILL",
}
_FATAL = re.compile(r"Fatal Python error: ([\w\- ]{1,40})")
_THREAD = re.compile(
    r"(?:Current thread|Thread) 0x[0-9a-f]{1,16}.{0,40}\(most recent call first\):"
)
_FRAME = re.compile(r'  File "([^"]{1,500})", line (\d{1,9}) in (.{1,500})')
#: The account of a process that has left none, but a dump.
_NOTHING: dict[str, Any] = {
    **{"is_blind": False, "ends": [], "waits": [], "slow": [], "timers": [], "caught": []},
    **{"ran": [], "spun_s": None, "stop": None, "raised": None, "returned_s": None},
}


class EvidencePage:
    """The grader's side of the page.

    Attributes:
        page: a descriptor that the submission's process inherits.
    """

    def __init__(self) -> None:
        self.page = account.make()
        self._account = self._dump = b""
        self._is_last = False

    def close(self) -> None:
        """Read the account and the dump as they are now, and close the page."""
        if self.page >= 0:
            self._account, self._is_last = account.read(self.page)
            self._dump = account.dumped(self.page)
            os.close(self.page)
            self.page = -1

    def request_dump(self, pid: int) -> None:
        """Have a running process dump where its threads are, and wait for the dump."""
        before, patience_s = account.dumped(self.page), PATIENCE_S

        def has_more() -> bool:
            return account.dumped(self.page) != before

        with suppress(OSError):
            os.kill(pid, account.DUMP_SIGNAL)
            while _awaited(pid, has_more, patience_s):
                before, patience_s = account.dumped(self.page), QUIET_S

    def await_last_write(self, pid: int) -> None:
        """Wait until a process has written its last account, or has ended, when its run is over."""
        _awaited(pid, lambda: account.read(self.page)[1], PATIENCE_S)

    def observations(
        self, submission: Submission, ended_s: float, *, computes: bool
    ) -> Observations:
        """Return the observations; empty ones where the account is missing or invalid.

        Args:
            ended_s: how far the process has got, on the clock of the run [s].
            computes: it would have gone on without waiting for anything.
        """
        self.close()
        try:
            read = self._account, self._is_last, self._dump
            return _observations(*read, submission, ended_s, computes)
        except (ValueError, TypeError, LookupError, AttributeError, RecursionError):
            return Observations()


def _awaited(pid: int, has_come: Callable[[], bool], patience_s: float) -> bool:
    """Wait until something comes; return whether it has. Waiting for a processor is free."""
    used_s, slept_s = linux.process_stat(pid).cpu_s, 0.0
    gives_up = time.monotonic() + LONGEST_S
    while not has_come():
        now = linux.process_stat(pid)
        if now.has_ended or now.cpu_s - used_s + slept_s >= patience_s:
            return has_come()
        if time.monotonic() > gives_up:
            return False
        time.sleep(PERIOD_S)
        slept_s += 0.0 if now.state == "R" else PERIOD_S
    return True


# The account ----------------------------------------------------------------------------------


def _observations(
    data: bytes,
    is_last: bool,
    dumped: bytes,
    submission: Submission,
    ended_s: float,
    computes: bool,
) -> Observations:
    """Decode an account; raise ValueError and its like where our own code did not write it."""
    files = SubmissionFiles(str(submission.root))
    signal, threads = _read_dump(dumped.decode("ascii").splitlines(), files)
    if not data and not threads:
        return Observations()
    summary = strict_json.loads(data.decode("ascii")) if data else dict(_NOTHING)
    if summary.pop("is_blind"):
        raise ValueError("our own code does not know this rclpy")
    if all(summary[key] is None for key in ("stop", "raised", "returned_s")):
        summary |= _ending(signal, threads, files, ended_s, computes=computes)
    ran = [strict_json.from_json(RanFile, each, STRANGERS) for each in summary.pop("ran")]
    found = list(submission.lint_findings)
    for file in ran:
        for at in file.raised:
            text = files.row(str(submission.root / file.file), at.line)["text"]
            place = SourceLine(file.file, at.line, "", text)
            found.append(LintFinding("raises", at.text, "", place))
    for diagnoser in extensions.load_all(extensions.DIAGNOSES):
        found = list(diagnoser.in_run(found, ran, is_last))
    observations = Observations.from_json(
        summary | {"is_known": True, "lint_findings": list(map(strict_json.to_json, found))}
    )
    shown: Observations = _as_submitted(observations, submission)
    return shown


def _as_submitted(value: Any, submission: Submission) -> Any:
    """Replace the paths of a run's copy by those of the submission."""
    if isinstance(value, tuple):
        return tuple(_as_submitted(each, submission) for each in value)
    if not is_dataclass(value) or isinstance(value, type):
        return value
    names = [each.name for each in fields(value)]
    parts = {name: _as_submitted(getattr(value, name), submission) for name in names}
    if isinstance(value, SourceLine):
        top = submission.copy.folder if submission.copy else submission.root
        folder = submission.root.relative_to(top).as_posix()
        parts["file"] = value.file if folder == "." else f"{folder}/{value.file}"
    if isinstance(value, Raised | Caught):
        parts["text"] = submission.with_original_paths(value.text)[: int(STRANGERS.characters)]
    return replace(value, **parts)


# Dumps ----------------------------------------------------------------------------------------


def _read_dump(lines: list[str], files: SubmissionFiles) -> tuple[str, list[list[Frame]]]:
    """Parse the last dump in these lines: the fault in C, '' for none, and the threads' frames.

    The thread that wrote it comes first, the main thread last.
    """
    fatal, threads = "", list[list[Frame]]()
    for line in lines:
        if found := _FATAL.match(line):
            fatal, threads = SIGNALS.get(found[1], found[1]), []
        elif _THREAD.match(line):
            threads.append([])
        elif (found := _FRAME.fullmatch(line)) and threads:
            function = "" if found[3] == "<module>" else found[3]
            threads[-1].append(files.frame(found[1], int(found[2]), function))
    return fatal, threads


def _ending(
    fatal: str,
    threads: list[list[Frame]],
    files: SubmissionFiles,
    ended_s: float,
    *,
    computes: bool,
) -> dict[str, Any]:
    """Return how a process has ended, or where it got stuck; nothing where no dump shows it."""
    if fatal:
        last = ending.last_line(threads[0]) if threads else None
        place = files.row_of_frame(last) if last else None
        return {"raised": {"type": fatal, "text": "", "time_s": ended_s, "place": place}}
    if computes:
        found = ending.computing(threads)
    else:
        found = ending.waiting(threads) or (ending.standing(threads[-1]) if threads else None)
    return {"stop": found.row(files, ended_s)} if found else {}
