"""What cannot run in virtual time, and how that is noticed.

Nothing here forbids a submission anything: the run is broken off, and done again in real time.
"""

from __future__ import annotations

import _posixsubprocess
import os
import sys
from collections.abc import Callable
from typing import Any

from grader.run.lockstep.faults import pass_on

#: What makes another process: Python's own audit events.
_OTHER_PROCESS = {
    "subprocess.Popen": "starts another program",
    "os.system": "starts another program",
    "os.exec": "becomes another program",
    "os.posix_spawn": "starts another program",
    "os.spawn": "starts another program",
    "os.fork": "forks (subprocess or multiprocessing)",
    "os.forkpty": "forks",
    "pty.spawn": "starts another program",
}
#: Programs that end at once and tell nobody the time; ctypes.util and platform start some.
_HARMLESS = {"cc", "clear", "gcc", "ld", "ldconfig", "objdump", "uname"}


class Unsupported(Exception):
    """Virtual time cannot follow; the text says what, to complete "the submission ..."."""


def watch(refuse: Callable[[str], None]) -> None:
    """Call `refuse` with what the submission does, when it does what virtual time cannot follow.

    An audit hook cannot be taken away again, and hears what C code does through Python as well.
    """
    harmless = False  # between the start of a harmless program and its fork

    def hook(event: str, args: tuple[Any, ...]) -> None:
        nonlocal harmless
        if event not in _OTHER_PROCESS:
            return
        if event in ("subprocess.Popen", "os.system"):
            harmless = _program(args[0]) in _HARMLESS
        if not harmless:
            what = f" ({_program(args[0])})" if args and event != "os.fork" else ""
            refuse(_OTHER_PROCESS[event] + what)

    sys.addaudithook(hook)
    start = _posixsubprocess.fork_exec

    def fork_exec(*args: Any) -> int:
        # multiprocessing's "spawn" comes this way, without an event
        if not harmless:
            refuse("starts another process (multiprocessing)")
        return int(pass_on(start, *args))

    _posixsubprocess.fork_exec = fork_exec


def _program(command: object) -> str:
    """The name of the program that a command starts."""
    if isinstance(command, (list, tuple)):
        command = command[0] if command else ""
    try:
        text = os.fsdecode(command)  # type: ignore[arg-type]
    except TypeError:
        return ""
    return os.path.basename(text.split()[0]) if text.split() else ""  # noqa: PTH119
