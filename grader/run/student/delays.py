"""What a submission waits for, its timers, and which callbacks let time pass.

`Waits` are those for a service, its answer or an action server that last, or are in vain.
`Callbacks` adds up, while one runs, how long each of the submission's own lines has waited.
"""

from __future__ import annotations

import sys
from _thread import get_ident
from dataclasses import asdict, dataclass
from types import CodeType
from typing import Any

from grader.run.student.telling import Teller

#: A wait that was not in vain is told of from here on [s].
LONG_S = 1.0
#: Time that a callback may let pass, as publishing does [s]: a tick.
SHORT_S = 0.016
MOST = 100

#: A line of the submission's own.
Where = tuple[CodeType, int]


@dataclass
class Wait:
    """A wait for something, which may be made up of several in vain.

    Attributes:
        lasted_s: how long, when it was over last.
        is_told: whether it is one that is told of.
    """

    name: str
    type: str
    since_s: float
    place: dict[str, Any] | None
    lasted_s: float = 0.0
    is_going_on: bool = True
    is_told: bool = False


class Waits:
    """All waits; who waits says what `since` has given him, and whether it has come."""

    def __init__(self, teller: Teller) -> None:
        self._teller = teller
        self._open: dict[tuple[str, str], Wait] = {}
        self._told: list[Wait] = []

    def since(self, name: str, kind: str) -> Wait:
        """A wait begins, or goes on after one in vain for the same."""
        wait = self._open.get((name, kind))
        if wait is None:
            place = self._teller.place(sys._getframe())
            wait = self._open[name, kind] = Wait(name, kind, self._teller.now_s(), place)
        wait.is_going_on = True
        return wait

    def over(self, wait: Wait, *, has_come: bool) -> None:
        """It has come, or nobody waits any longer."""
        wait.is_going_on = False
        wait.lasted_s = self._since_s(wait)
        if has_come:
            self._open.pop((wait.name, wait.type), None)
        if wait.lasted_s > LONG_S or not has_come:
            self._take(wait)

    def look(self) -> None:
        """Take those that still go on."""
        for wait in list(self._open.values()):
            if wait.is_going_on and self._since_s(wait) > LONG_S:
                self._take(wait)

    def _take(self, wait: Wait) -> None:
        if not wait.is_told and len(self._told) < MOST:
            wait.is_told = True
            self._told.append(wait)
            self._teller.account.write()
        self._teller.account.changed()

    def _since_s(self, wait: Wait) -> float:
        return self._teller.now_s() - wait.since_s

    def told(self) -> list[dict[str, Any]]:
        """Those that are told of."""
        return [
            {
                **{"name": wait.name, "type": wait.type, "since_s": wait.since_s},
                "lasted_s": None
                if wait.is_going_on and self._since_s(wait) > LONG_S
                else wait.lasted_s,
                "place": wait.place,
            }
            for wait in list(self._told)
        ]


@dataclass
class Slow:
    """A line at which callbacks let time pass; see `grader.recording.conduct.Slow`."""

    place: dict[str, Any]
    longest_s: float = 0.0
    times: int = 0


class Callbacks:
    """What runs in an executor now, by thread, and which lines took how long."""

    def __init__(self, teller: Teller) -> None:
        self._teller = teller
        self._running: dict[int, dict[Where, float]] = {}
        self._slow: dict[Where, Slow] = {}

    def begin(self) -> dict[Where, float] | None:
        """A callback begins in this thread; None if one runs there already."""
        thread = get_ident()
        if thread in self._running:
            return None
        lines = self._running[thread] = {}
        return lines

    def end(self, lines: dict[Where, float]) -> None:
        """It has ended, having waited at these lines."""
        del self._running[get_ident()]
        total_s = sum(lines.values())
        if total_s > SHORT_S:
            self._add(max(lines, key=lambda where: lines[where]), total_s)

    def waited(self, lasted_s: float) -> None:
        """Time has passed while this thread waited."""
        lines = self._running.get(get_ident())
        if lines is None:
            return
        frame = sys._getframe()
        while frame is not None and not self._teller.is_own(frame.f_code.co_filename):
            frame = frame.f_back  # type: ignore[assignment]
        if frame is not None:
            where = frame.f_code, frame.f_lineno
            lines[where] = lines.get(where, 0.0) + lasted_s

    def _add(self, where: Where, total_s: float) -> None:
        slow = self._slow.get(where)
        if slow is None:
            if len(self._slow) >= MOST:
                return
            slow = self._slow[where] = Slow(self._teller.line(*where))
        slow.times += 1
        slow.longest_s = max(slow.longest_s, total_s)
        self._teller.account.changed()

    def told(self) -> list[dict[str, Any]]:
        """All lines."""
        return [
            {"place": each.place, "longest_s": round(each.longest_s, 9), "times": each.times}
            for each in list(self._slow.values())
        ]


@dataclass
class Timer:
    """A line that makes timers; see `grader.recording.conduct.Timer`."""

    place: dict[str, Any]
    period_s: float = 0.0
    times: int = 0


class Timers:
    """All timers, by the line that has made them."""

    def __init__(self, teller: Teller) -> None:
        self._teller = teller
        self._made: dict[tuple[str, int], Timer] = {}

    def made(self, place: dict[str, Any] | None, period_s: float) -> None:
        """The program has made one, there."""
        if place is None:
            return
        where = place["file"], place["line"]
        if where not in self._made and len(self._made) >= MOST:
            return
        timer = self._made.setdefault(where, Timer(place))
        timer.times, timer.period_s = timer.times + 1, period_s
        self._teller.account.changed()

    def told(self) -> list[dict[str, Any]]:
        """All lines."""
        return [asdict(each) for each in list(self._made.values())]
