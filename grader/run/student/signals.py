"""Signals that a program sends to itself: its handlers run when the main thread has the baton."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from types import FrameType
from typing import Any

from grader.run.lockstep import real
from grader.run.lockstep.faults import pass_on
from grader.run.student.scheduler import Scheduler

Handler = Callable[[int, FrameType | None], Any]


def install(scheduler: Scheduler, refuse: Callable[[str], None]) -> None:
    """Replace `signal.signal`, and refuse signals that come at a real time."""
    waiting: list[Callable[[], Any]] = []
    handlers: dict[int, Any] = {signal.SIGINT: signal.default_int_handler}
    original = signal.signal

    def deliver(number: int, frame: FrameType | None) -> None:
        handler = handlers[number]
        if scheduler.inside:
            # The main thread stands at its gate while another one runs: wait for its turn.
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
        refuse("asks for a signal after a real time (alarm, setitimer)")

    scheduler.on_leaving = run_waiting
    signal.signal = replacement
    signal.getsignal = lambda number, ask=signal.getsignal: handlers.get(number, ask(number))  # type: ignore[misc]
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.kill = sender(os.kill, lambda pid, _: pid == os.getpid())
    signal.raise_signal = sender(signal.raise_signal, lambda _: True)
    signal.alarm = signal.setitimer = refused  # type: ignore[assignment]


def _await(has_come: Callable[[], bool], scheduler: Scheduler) -> None:
    """Another thread has sent a signal: really wait until the main thread has noticed."""
    deadline = real.monotonic() + 1.0
    while scheduler.inside and not has_come() and real.monotonic() < deadline:
        real.sleep(0.001)
