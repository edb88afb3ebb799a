"""`select` and `selectors`, and so asyncio: waiting for files, sockets and pipes."""

from __future__ import annotations

import select
import selectors
from collections.abc import Callable
from typing import Any

from grader.run.lockstep.faults import guarded, pass_on
from grader.run.lockstep.times import NEVER
from grader.run.student.scheduler import Runner, Scheduler


def install(scheduler: Scheduler) -> None:
    """Replace waiting in this interpreter."""
    waiting: list[tuple[Runner, Callable[[], Any]]] = []

    def look() -> None:
        for runner, ready in waiting:
            if ready():
                scheduler.wake(runner)

    def wait(ready: Callable[[], Any], timeout_s: float | None) -> Any:
        """What `ready` returns once that is something, or the time is out."""
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

    scheduler.pollers.append(look)
    for kind in (selectors.EpollSelector, selectors.PollSelector, selectors.SelectSelector):
        _replace_select(kind, wait)
    real_select = select.select

    def virtual_select(
        rlist: Any, wlist: Any, xlist: Any, timeout: float | None = None
    ) -> tuple[list[Any], list[Any], list[Any]]:
        def ready() -> Any:
            found = pass_on(real_select, rlist, wlist, xlist, 0)
            return found if any(found) else None

        return wait(ready, timeout) or ([], [], [])

    select.select = guarded(virtual_select)


def _replace_select(kind: Any, wait: Callable[..., Any]) -> None:
    real_select = kind.select

    def virtual_select(self: Any, timeout: float | None = None) -> Any:
        return wait(lambda: pass_on(real_select, self, 0), timeout)

    kind.select = guarded(virtual_select)
