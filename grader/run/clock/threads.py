"""Locks and threads that pass the baton on instead of blocking.

All of `threading`, `queue` and `concurrent.futures` is built on these few; Python's own reentrant
lock, too, where it takes the one that is written in Python.
"""

from __future__ import annotations

import _thread
import queue
import threading
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from grader.run.clock.scheduler import Runner, Scheduler
from grader.run.lockstep.faults import as_python_does, pass_on
from grader.run.lockstep.protocol import NEVER

SCHEDULER: Scheduler


class Lock:
    """As `_thread.lock`."""

    __slots__ = ("__weakref__", "_locked", "_waiting")

    def __init__(self) -> None:
        self._locked = False
        self._waiting = deque[Runner]()

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Acquire the lock; return False where that is not possible in time."""
        if not self._locked and timeout == -1:
            self._locked = True
            return True
        if not blocking and timeout != -1:
            as_python_does(ValueError("can't specify a timeout for a non-blocking call"))
        if timeout < 0 and timeout != -1:
            as_python_does(ValueError("timeout value must be a non-negative number"))
        if self._locked and (not blocking or timeout == 0):
            SCHEDULER.charge()
            return False
        return self._wait(NEVER if timeout == -1 else SCHEDULER.now_ns + int(timeout * 1e9))

    def _wait(self, deadline_ns: int) -> bool:
        me = SCHEDULER.current
        while self._locked:
            if SCHEDULER.now_ns >= deadline_ns:
                return False
            self._waiting.append(me)
            try:
                SCHEDULER.block(deadline_ns)
            finally:
                if me in self._waiting:
                    self._waiting.remove(me)
        self._locked = True
        return True

    def release(self) -> None:
        if not self._locked:
            as_python_does(RuntimeError("release unlocked lock"))
        self._locked = False
        if self._waiting:
            SCHEDULER.wake(self._waiting.popleft())

    def locked(self) -> bool:
        return self._locked

    __enter__ = acquire

    def __exit__(self, *_: object) -> None:
        self.release()

    def _at_fork_reinit(self) -> None:
        self._locked = False
        self._waiting.clear()

    acquire_lock = acquire
    release_lock = release
    locked_lock = locked


class ThreadHandle:
    """As `_thread._ThreadHandle` of CPython 3.13, which joins a thread."""

    def __init__(self, ident: int = 0) -> None:
        self.ident = ident
        self._alive = Lock()

    def is_done(self) -> bool:
        return not self._alive.locked()

    def _set_done(self) -> None:
        if self._alive.locked():
            self._alive.release()

    def join(self, timeout: float | None = None) -> None:
        """Wait for the thread's end."""
        if self._alive.acquire(timeout=-1 if timeout is None or timeout < 0 else timeout):
            self._alive.release()


def install(scheduler: Scheduler) -> None:
    """Replace the primitives in this interpreter.

    Raises:
        AttributeError: this Python has other ones.
    """
    global SCHEDULER
    SCHEDULER = scheduler
    _thread.allocate_lock = Lock  # type: ignore[assignment]
    _thread.allocate = Lock  # type: ignore[assignment]
    _thread.LockType = Lock  # type: ignore[assignment, misc]
    _thread.start_new_thread = _start_new_thread
    _thread.start_new = _start_new_thread
    _thread.RLock = threading._PyRLock  # type: ignore[attr-defined, misc]
    _replace(threading, "_allocate_lock", Lock)
    _replace(threading, "Lock", Lock)
    _replace(threading, "_CRLock", None)
    if hasattr(threading, "_start_joinable_thread"):  # CPython 3.13
        _replace(threading, "_start_joinable_thread", _start_joinable_thread)
        _replace(threading, "_ThreadHandle", ThreadHandle)
    else:
        _replace(threading, "_start_new_thread", _start_new_thread)
        _replace(threading, "_set_sentinel", _set_sentinel)
    _replace(queue, "SimpleQueue", pass_on(getattr, queue, "_PySimpleQueue"))


def join_all() -> None:
    """Wait for all threads but daemons, as the interpreter does at its end."""
    for call in reversed(threading._threading_atexits):  # type: ignore[attr-defined]
        call()
    for thread in threading.enumerate():
        if thread is not threading.main_thread() and not thread.daemon:
            thread.join()


def _replace(module: Any, name: str, new: object) -> None:
    pass_on(getattr, module, name)
    setattr(module, name, new)


def _start_new_thread(
    function: Callable[..., object], args: tuple[Any, ...], kwargs: dict[str, Any] | None = None
) -> int:
    return SCHEDULER.spawn(lambda: _quietly(function, *args, **(kwargs or {})))


def _start_joinable_thread(
    function: Callable[[], object], handle: ThreadHandle | None = None, daemon: bool = True
) -> ThreadHandle:
    started = handle or ThreadHandle()
    started._alive.acquire()
    started.ident = SCHEDULER.spawn(lambda: _quietly(function), started._set_done)
    return started


def _quietly(function: Callable[..., object], *args: Any, **kwargs: Any) -> None:
    with suppress(SystemExit):
        function(*args, **kwargs)


def _set_sentinel() -> Lock:
    """Return a lock that is released when the current thread ends; for CPython up to 3.12."""
    lock = Lock()

    def release() -> None:
        if lock.locked():
            lock.release()

    SCHEDULER.current.at_exit = release
    return lock
