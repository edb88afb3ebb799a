"""Looks on in real time, where rclpy is imported when the submission imports it.

What virtual time knows is asked of rclpy here: whether anybody has the other end of something. ROS
finds that out in its own time, so it is asked again until somebody has.
"""

from __future__ import annotations

import _thread
import atexit
import functools
import threading
import time
import weakref
from collections.abc import Callable
from types import ModuleType
from typing import Any

from grader.run.lockstep import faults
from grader.run.student import hooks, witness
from grader.run.student.telling import Teller

#: How often it is asked who is there [s].
PERIOD_S = 0.5
#: How rclpy tells whether there is another end: of each kind of end, a method and what it answers.
ASKS: dict[str, Callable[[Any], bool]] = {
    "publisher": lambda publisher: publisher.get_subscription_count() > 0,
    "subscription": lambda subscription: subscription.get_publisher_count() > 0,
    "client": lambda client: client.service_is_ready(),
    "action_client": lambda client: client.server_is_ready(),
}


class Looking:
    """The witness of a process in real time, and what it is called for.

    Attributes:
        calls: what is to be called when a module of rclpy has been loaded.
    """

    def __init__(self, page: int, root: str) -> None:
        started_s = time.monotonic()
        now, self._sleep = time.monotonic, time.sleep
        self._teller = Teller(page, root, lambda: now() - started_s)
        self._witness = witness.Witness(self._teller, self._is_met)
        self._is_asking = False
        self._code = -1
        self.calls: dict[str, Callable[[ModuleType], None]] = {
            "rclpy.node": lambda _: self._look_at_rclpy(),
            "rclpy.action.client": lambda _: hooks.install_actions(self._witness),
            "rclpy.experimental.events_executor": self._look_at_events,
        }
        time.sleep = self._timed(time.sleep)
        threading.excepthook = self._thread_raised
        # registered first, so called last: when all threads have ended that Python waits for
        atexit.register(self._end)

    def raised(self, error: BaseException) -> None:
        """An exception has ended the main thread."""
        self._witness.raised(error)
        faults.hide_our_frames(error)

    def _thread_raised(self, args: threading.ExceptHookArgs) -> None:
        if args.exc_value is not None:
            self._witness.thread_raised(args.exc_value)
            faults.hide_our_frames(args.exc_value)
            traceback = args.exc_value.__traceback__
            args = threading.ExceptHookArgs((args.exc_type, args.exc_value, traceback, args.thread))
        threading.__excepthook__(args)

    def returns(self, code: int) -> None:
        """The main thread is through; others may go on."""
        self._code = code

    def _end(self) -> None:
        if self._code >= 0:
            self._witness.returned(self._code)

    def _look_at_rclpy(self) -> None:
        hooks.install(self._witness)
        import rclpy.clock
        import rclpy.timer

        for kind, name in ((rclpy.clock.Clock, "sleep_until"), (rclpy.timer.Rate, "sleep")):
            setattr(kind, name, self._timed(getattr(kind, name)))

    def _timed(self, wait: Callable[..., Any]) -> Callable[..., Any]:
        """The same function, which tells for how long it has waited."""

        @functools.wraps(wait)
        def timed(*args: Any, **kwargs: Any) -> Any:
            before_s = time.monotonic()
            returned = wait(*args, **kwargs)
            self._witness.callbacks.waited(time.monotonic() - before_s)
            return returned

        return timed

    def _is_met(self, kind: str, entity: Any) -> Callable[[], bool]:
        """The entity itself is not to live longer for it."""
        alive = weakref.ref(entity)

        def ask() -> bool:
            there = alive()
            return there is not None and ASKS[kind](there)

        if not self._is_asking:
            self._is_asking = True
            _thread.start_new_thread(self._go_on_asking, ())
        return ask

    def _go_on_asking(self) -> None:
        while True:
            self._sleep(PERIOD_S)
            self._witness.look_for_others()

    def _look_at_events(self, module: Any) -> None:
        """An executor in C++, which calls nothing of Python's but callbacks."""
        make = module.EventsExecutor

        def events_executor(*args: Any, **kwargs: Any) -> Any:
            self._witness.spins()
            return make(*args, **kwargs)

        module.EventsExecutor = events_executor
