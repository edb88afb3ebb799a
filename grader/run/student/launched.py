"""The process of a submission that a launch file starts: one process more for each program.

    python launched.py AWAITED EVIDENCE ROOT PROGRAMS

PROGRAMS is a JSON list of [name, module:function, arguments]; all before it goes to each as to
`main.py`, but for EVIDENCE: into one pipe to the grader several must not write. In real time only.
It ends when all have ended, as the first did that did not end well.
"""

import json
import os
import signal
import sys
from contextlib import suppress
from pathlib import Path
from typing import Any

sys.path[0] = str(Path(__file__).resolve().parents[3])

from grader.run.student import main as student_main  # noqa: E402


def main() -> None:
    """Start the programs and wait for them."""
    _, awaited, _, root, programs = sys.argv
    names = {}
    for name, target, arguments in json.loads(programs):
        pid = os.fork()
        if pid == 0:
            become([awaited, "-1", root, target], arguments)
        names[pid] = name
    be_deaf()
    try:
        code = wait(names)
    except KeyboardInterrupt:
        code = 130
    if code < 0:
        signal.signal(-code, signal.SIG_DFL)
        os.kill(os.getpid(), -code)
    sys.exit(code)


def become(words: list[str], arguments: list[str]) -> None:
    """Go on as one of the programs; ends the process."""
    sys.argv = [student_main.__file__, *words]
    sys.modules["__main__"] = student_main
    sys.path[0] = str(Path(student_main.__file__).parent)
    student_main.main(arguments)


def be_deaf() -> None:
    """Ignore what asks a program where it is: this is none."""
    for number in (getattr(signal, "SIGUSR1", 0), getattr(signal, "SIGUSR2", 0), *_real_time()):
        with suppress(OSError, ValueError):
            signal.signal(number, signal.SIG_IGN)


def _real_time() -> range:
    first, last = getattr(signal, "SIGRTMIN", 0), getattr(signal, "SIGRTMAX", -1)
    return range(first, last + 1)


def wait(names: dict[int, str]) -> int:
    """Wait until all have ended; the exit code of the first that did not end well, else 0."""
    code = 0
    while names:
        pid, status = os.wait()
        name: Any = names.pop(pid, None)
        ended = os.waitstatus_to_exitcode(status)
        if name is not None and ended:
            print(f"{name} has ended with exit code {ended}", file=sys.stderr, flush=True)
            code = code or ended
    return code


if __name__ == "__main__":
    main()
