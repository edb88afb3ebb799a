"""Waits for the operating system by the scheduler; refuses what virtual time cannot follow.

`select` and `selectors`, and so asyncio, wait for files, sockets and pipes by the scheduler. Signal
handlers run when the main thread has the baton. Other processes and alarms are refused: that
forbids a submission nothing, the run is broken off and made again in real time.
"""

from __future__ import annotations

import _posixsubprocess
import os
import select
import selectors
import signal
import sys
from collections.abc import Callable
from types import FrameType
from typing import Any

from grader.run.clock.scheduler import Runner, Scheduler
from grader.run.lockstep import real
from grader.run.lockstep.faults import guarded, pass_on
from grader.run.lockstep.protocol import NEVER
from grader.text.message import NOTHING, Message, msg

_STARTS = (msg("starts another program"), msg("starts another program ({program})"))
#: Python's audit events of another process -> what the program does, and that with a name.
_OTHER_PROCESS = {
    "subprocess.Popen": _STARTS,
    "os.system": _STARTS,
    "os.exec": (msg("becomes another program"), msg("becomes another program ({program})")),
    "os.posix_spawn": _STARTS,
    "os.spawn": _STARTS,
    "os.fork": (msg("forks (subprocess or multiprocessing)"), NOTHING),
    "os.forkpty": (msg("forks"), NOTHING),
    "pty.spawn": _STARTS,
}
#: Programs that end at once and have no use for time; ctypes.util and platform start some.
_HARMLESS = {"cc", "clear", "gcc", "ld", "ldconfig", "objdump", "uname"}


# Files, sockets and pipes ---------------------------------------------------------------------


def replace_select(scheduler: Scheduler) -> None:
    """Replace waiting for files in this interpreter."""
    waiting: list[tuple[Runner, Callable[[], Any]]] = []

    def wake_ready() -> None:
        for runner, ready in waiting:
            if ready():
                scheduler.wake(runner)

    def wait(ready: Callable[[], Any], timeout_s: float | None) -> Any:
        """Wait until `ready` returns something or the time is out; return its answer."""
        deadline_ns = NEVER
        if timeout_s is not None:
            deadline_ns = scheduler.now_ns + max(0, int(timeout_s * 1e9))
        scheduler.charge(10)
        scheduler.pass_on()
        while not (found := ready()) and scheduler.now_ns < deadline_ns:
            entry = (scheduler.current, ready)
            waiting.append(entry)
            try:
                scheduler.block(deadline_ns)
            finally:
                waiting.remove(entry)
        return found

    scheduler.poll = wake_ready

    def replace_selector(kind: Any) -> None:
        ask = kind.select
        kind.select = guarded(
            lambda self, timeout=None: wait(lambda: pass_on(ask, self, 0), timeout)
        )

    for kind in (selectors.EpollSelector, selectors.PollSelector, selectors.SelectSelector):
        replace_selector(kind)
    real_select = select.select

    def virtual_select(
        rlist: Any, wlist: Any, xlist: Any, timeout: float | None = None
    ) -> tuple[list[Any], list[Any], list[Any]]:
        def ready() -> Any:
            found = pass_on(real_select, rlist, wlist, xlist, 0)
            return found if any(found) else None

        return wait(ready, timeout) or ([], [], [])

    select.select = guarded(virtual_select)


# Signals --------------------------------------------------------------------------------------


def replace_signals(scheduler: Scheduler, refuse: Callable[[Message], None]) -> None:
    """Replace `signal.signal`, and refuse signals that come at a real time."""
    waiting: list[Callable[[], Any]] = []
    handlers: dict[int, Any] = {signal.SIGINT: signal.default_int_handler}
    original = signal.signal

    def deliver(number: int, frame: FrameType | None) -> None:
        handler = handlers[number]
        if scheduler.inside:
            # The main thread waits at its gate while another one runs: wait for its turn.
            waiting.append(lambda: handler(number, frame))
            scheduler.interrupted = True
        else:
            handler(number, frame)

    def run_waiting() -> None:
        while waiting:
            waiting.pop(0)()

    def replacement(signalnum: int, handler: Any) -> Any:
        before = handlers.get(signalnum, signal.getsignal(signalnum))
        pass_on(original, signalnum, deliver if callable(handler) else handler)
        handlers[signalnum] = handler
        return before

    def sender(send: Callable[..., None], is_to_us: Callable[..., bool]) -> Callable[..., None]:
        def sent(*args: Any) -> None:
            pass_on(send, *args)
            if is_to_us(*args) and callable(handlers.get(args[-1])):
                _await(lambda: bool(waiting), scheduler)

        return sent

    def refused(*_: object) -> None:
        refuse(msg("asks for a signal after a real time (alarm, setitimer)"))

    scheduler.on_leaving = run_waiting
    signal.signal = replacement
    signal.getsignal = lambda number, ask=signal.getsignal: handlers.get(number, ask(number))  # type: ignore[misc]
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.kill = sender(os.kill, lambda pid, _: pid == os.getpid())
    signal.raise_signal = sender(signal.raise_signal, lambda _: True)
    signal.alarm = signal.setitimer = refused  # type: ignore[assignment]


def _await(has_come: Callable[[], bool], scheduler: Scheduler) -> None:
    """Wait, in real time, until the main thread has noticed a signal of another thread's."""
    deadline = real.monotonic() + 1.0
    while scheduler.inside and not has_come() and real.monotonic() < deadline:
        real.sleep(0.001)


# Other processes ------------------------------------------------------------------------------


def refuse_processes(refuse: Callable[[Message], None]) -> None:
    """Call `refuse` when the submission makes another process, with what it does.

    An audit hook cannot be removed again, and also gets what C code does through Python.
    """
    harmless = False  # between the start of a harmless program and its fork

    def hook(event: str, args: tuple[Any, ...]) -> None:
        nonlocal harmless
        if event not in _OTHER_PROCESS:
            return
        if event in ("subprocess.Popen", "os.system"):
            harmless = _program(args[0]) in _HARMLESS
        if not harmless:
            what, named = _OTHER_PROCESS[event]
            refuse(named.given(program=_program(args[0])) if args and named else what)

    sys.addaudithook(hook)
    start = _posixsubprocess.fork_exec

    def fork_exec(*args: Any) -> int:
        # multiprocessing's "spawn" comes this way, without an event
        if not harmless:
            refuse(msg("starts another process (multiprocessing)"))
        return int(pass_on(start, *args))

    _posixsubprocess.fork_exec = fork_exec


def _program(command: object) -> str:
    """Return the name of the program that a command starts."""
    if isinstance(command, (list, tuple)):
        command = command[0] if command else ""
    try:
        text = os.fsdecode(command)  # type: ignore[arg-type]
    except TypeError:
        return ""
    return os.path.basename(text.split()[0]) if text.split() else ""  # noqa: PTH119
