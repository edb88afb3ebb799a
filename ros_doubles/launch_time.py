"""When a launch file does what: timers, and what happens when a program starts or ends.

Nothing is started, so nobody knows how long a program runs: what waits for its end has a moment
that counts from there. Where the launch is shut down, what would follow at a moment that counts
from the same end does not. ROS's launch does first what a file says, then what its timers and
events lead to, by time; what is visited in that order here has the numbers that it gives programs.
"""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Iterable
from typing import Any, Final, NamedTuple

#: In place of the number of a program that is waited for: with the launch; nobody knows when.
WITH_THE_LAUNCH: Final = -1
NEVER: Final = -2
#: So many actions may wait, and so many are done: some have others wait without end.
_MOST_WAITING, _MOST_DONE = 400, 800


class LaunchMoment(NamedTuple):
    """When something happens: so long after the end of a program."""

    after: int
    delay_s: float


START: Final = LaunchMoment(WITH_THE_LAUNCH, 0.0)


class Waiting(NamedTuple):
    """Actions that wait for their moment, or an event for which handlers wait.

    Attributes:
        number: what comes first at one moment.
        place: of what has them wait, in the order of the file.
        scope: the locals of their context.
        is_later: whether something else has to happen before.
    """

    when: LaunchMoment
    number: int
    entities: Any
    place: tuple[int, ...]
    scope: dict[str, Any]
    is_later: bool


class LaunchTime:
    """The time of a launch file that is evaluated.

    Attributes:
        when: of what is visited now.
        is_later: whether something else has to happen before it.
    """

    def __init__(self, record: Any) -> None:
        """`record`: of what is visited; its context is the launch file's."""
        self.when, self.is_later = START, False
        self._record, self._place = record, tuple[int, ...]()
        self._numbers = itertools.count()
        self._waiting: list[Waiting] = []
        #: with their places, and whether what they wait for has come
        self._handlers: dict[Any, tuple[tuple[int, ...], bool]] = {}
        #: programs after whose ends the launch was shut down
        self._over = set[int]()

    def next_place(self) -> tuple[int, ...]:
        """Return a place in the order of the file, for what is visited now."""
        return (*self._place, next(self._numbers))

    def later(self, entities: Any, delay_s: float) -> None:
        """Have actions wait [s]."""
        after, before_s = self.when
        self._put(LaunchMoment(after, before_s + delay_s), entities, is_later=self.is_later)

    def handler(self, handler: Any) -> None:
        """Have actions wait for an event."""
        self._handlers[handler] = self.next_place(), False

    def unregister(self, handler: Any) -> None:
        """Have a handler wait no longer; ValueError: it does not."""
        if handler not in self._handlers:
            raise ValueError("the event handler is not registered")
        del self._handlers[handler]

    def started(self, number: int, name: str, action: Any) -> None:
        """Note that a program starts now, and so may end."""
        from launch.events.process import ProcessExited, ProcessStarted

        if self.when.after != NEVER:
            ended = LaunchMoment(number, 0.0)
            self._put(self.when, ProcessStarted(action=action, name=name), is_later=True)
            self._put(ended, ProcessExited(action=action, name=name), is_later=True)

    def executed(self, action: Any) -> None:
        """Note that an action was done, which is at its end, unless it starts or waits."""
        from launch.actions import ExecuteLocal, TimerAction
        from launch.events import ExecutionComplete

        event = ExecutionComplete(action=action)
        if not isinstance(action, ExecuteLocal | TimerAction) and self._met(event):
            self._put(self.when, event, is_later=True)

    def shut_down(self) -> None:
        """Note that nothing is started any more after this."""
        from launch.events import Shutdown

        self._put(self.when, Shutdown(), is_later=True)

    def let_pass(self) -> None:
        """Do what waits; and last what waits for something that does not come."""
        from launch.events import Happened

        for _ in range(_MOST_DONE):
            if self._waiting:
                self._do(heapq.heappop(self._waiting))
        scope = dict(self._record.context.locals_)
        for handler, (place, has_come) in [*self._handlers.items()]:
            if not has_come and callable(handler.entities):
                self._record.ignored("a function for an event")
            elif not has_come:
                self._begin(LaunchMoment(NEVER, 0.0), place, scope | {"event": Happened()})
                self._walk(handler.entities)

    def _put(self, when: LaunchMoment, entities: Any, *, is_later: bool) -> None:
        scope, place = dict(self._record.context.locals_), self.next_place()
        waiting = Waiting(when, next(self._numbers), entities, place, scope, is_later)
        if len(self._waiting) < _MOST_WAITING and when.after not in self._over:
            heapq.heappush(self._waiting, waiting)

    def _met(self, event: Any) -> list[Any]:
        """The handlers that wait for an event; the last comes first."""
        return [each for each in reversed(self._handlers) if each.matches(event)]

    def _begin(
        self,
        when: LaunchMoment,
        place: tuple[int, ...],
        scope: dict[str, Any],
        *,
        later: bool = True,
    ) -> None:
        self.when, self._place, self.is_later = when, place, later
        self._record.context.locals_ = dict(scope)

    def _do(self, waiting: Waiting) -> None:
        from launch.events import Event, ExecutionComplete, Shutdown
        from launch.events.process import ProcessExited

        when, event = waiting.when, waiting.entities
        if not isinstance(event, Event):
            self._begin(when, waiting.place, waiting.scope, later=waiting.is_later)
            self._walk(event)
            return
        met = self._met(event)
        if isinstance(event, ProcessExited):
            met += self._met(ExecutionComplete(action=event.action))
        for handler in met:
            place, _ = self._handlers[handler]
            self._handlers[handler] = place, True
            if handler.handle_once or not callable(handler.entities):
                del self._handlers[handler]  # the same actions are not started twice
            self._begin(when, place, waiting.scope | {"event": event})
            self._walk(handler.handle(event, self._record.context))
        if isinstance(event, Shutdown):
            self._over.add(when.after)
            self._waiting = [each for each in self._waiting if each.when.after != when.after]
            heapq.heapify(self._waiting)

    def _walk(self, entities: Any) -> None:
        """Visit one action or several; None is no action."""
        from launch._core import walk

        several = entities if isinstance(entities, Iterable) else (entities,)
        walk([each for each in several if each is not None], self._record.context)
