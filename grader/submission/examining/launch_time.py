"""When a launch file does what: timers, and what happens when a program starts or ends.

Nothing is started, so nobody knows how long a program runs: what waits for its end has a moment
that counts from there. ROS's launch does first what a file says, then what its timers and events
lead to, by time; what is visited in that order here has the numbers that it gives programs.
"""

from __future__ import annotations

import heapq
import itertools
from typing import Any, Final, NamedTuple

#: After which program something happens, by its number; or after none, or nobody knows.
WITH_THE_LAUNCH, NEVER = -1, -2
#: So many actions may wait, and so many are done: some have others wait without end.
_MOST_WAITING, _MOST_DONE = 400, 800


class LaunchMoment(NamedTuple):
    """When something happens: so long after the end of a program."""

    after: int
    delay_s: float


START: Final = LaunchMoment(WITH_THE_LAUNCH, 0.0)


class Change(NamedTuple):
    """What a program does: `start` or `exit`; and the action that it is."""

    on: str
    action: Any


class Waiting(NamedTuple):
    """Actions that wait for their moment, or a change for which handlers wait.

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
        #: with their places
        self._handlers: list[tuple[Any, tuple[int, ...]]] = []

    def next_place(self) -> tuple[int, ...]:
        """Return a place in the order of the file, for what is visited now."""
        return (*self._place, next(self._numbers))

    def later(self, entities: Any, delay_s: float) -> None:
        """Have actions wait [s]."""
        after, before_s = self.when
        self._put(LaunchMoment(after, before_s + delay_s), entities, is_later=self.is_later)

    def handler(self, handler: Any) -> None:
        """Have actions wait for what a program does."""
        self._handlers.append((handler, self.next_place()))

    def started(self, number: int, action: Any) -> None:
        """Note that a program starts now, and so may end."""
        if self.when.after != NEVER:
            self._put(self.when, Change("start", action), is_later=True)
            self._put(LaunchMoment(number, 0.0), Change("exit", action), is_later=True)

    def let_pass(self) -> None:
        """Do what waits; and last what waits for something that does not come."""
        for _ in range(_MOST_DONE):
            if self._waiting:
                self._do(heapq.heappop(self._waiting))
        while self._handlers:
            handler, place = self._handlers.pop(0)
            never, scope = LaunchMoment(NEVER, 0.0), dict(self._record.context.locals_)
            self._do(Waiting(never, 0, handler.entities, place, scope, is_later=True))

    def _put(self, when: LaunchMoment, entities: Any, *, is_later: bool) -> None:
        scope, place = dict(self._record.context.locals_), self.next_place()
        waiting = Waiting(when, next(self._numbers), entities, place, scope, is_later)
        if len(self._waiting) < _MOST_WAITING:
            heapq.heappush(self._waiting, waiting)

    def _do(self, waiting: Waiting) -> None:
        from launch._core import walk
        from launch.events import Happened

        self.when, self._place, self.is_later = waiting.when, waiting.place, waiting.is_later
        self._record.context.locals_ = {"event": Happened(), **waiting.scope}
        if isinstance(waiting.entities, Change):
            on, action = waiting.entities
            met = [e for e in self._handlers if e[0].on == on and e[0].target is action is not None]
            for handler in reversed(met):  # the last comes first
                self._handlers.remove(handler)
                self._do(waiting._replace(entities=handler[0].entities, place=handler[1]))
        elif callable(waiting.entities):
            self._record.ignored("a function for an event")
        else:
            walk(waiting.entities, self._record.context)
