"""What a submission waits for, its timers, and which callbacks let time pass; told like all else.

`Waits` are those for a service, its answer or an action server that last, or are in vain.
`Callbacks` adds up, while one runs, how long each of the submission's own lines has waited.
"""

from __future__ import annotations

import sys
from _thread import get_ident
from dataclasses import dataclass
from types import CodeType
from typing import Any

from grader.run.student.telling import Teller

#: A wait that was not in vain is told of from here on [s].
LONG_S = 1.0
#: Time that a callback may let pass, as publishing does [s]: a tick.
SHORT_S = 0.016
MOST = 100
#: How often, and how long, is told again when it is so many times as much.
STEP = 4

#: A line of the submission's own.
Where = tuple[CodeType, int]


@dataclass
class Wait:
    """A wait for something, which may be made up of several in vain.

    Attributes:
        number: in the order in which they were told of; -1: not yet.
        told_s: how long it had lasted when that was told last.
    """

    name: str
    type: str
    since_s: float
    place: dict[str, Any] | None
    number: int = -1
    told_s: float = 0.0
    is_going_on: bool = True


class Waits:
    """All waits; who waits says what `since` has given him, and whether it has come."""

    def __init__(self, teller: Teller) -> None:
        self._teller = teller
        self._open: dict[tuple[str, str], Wait] = {}
        self._told = 0

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
        lasted_s = self._teller.now_s() - wait.since_s
        if has_come:
            self._open.pop((wait.name, wait.type), None)
            is_news = lasted_s > LONG_S or wait.number >= 0
        else:
            is_news = lasted_s > STEP * wait.told_s
        if is_news:
            self._tell(wait, lasted_s)

    def look(self, *, is_last: bool = False) -> None:
        """Tell of those that still go on."""
        for wait in list(self._open.values()):
            lasted_s = self._teller.now_s() - wait.since_s
            if wait.is_going_on and (wait.number < 0 or is_last) and lasted_s > LONG_S:
                self._tell(wait, None)
            elif is_last and not wait.is_going_on:
                self._tell(wait, max(wait.told_s, lasted_s if wait.number < 0 else 0.0))

    def _tell(self, wait: Wait, lasted_s: float | None) -> None:
        if wait.number < 0:
            if self._told >= MOST:
                return
            wait.number, self._told = self._told, self._told + 1
        wait.told_s = wait.told_s if lasted_s is None else lasted_s
        told = {"name": wait.name, "type": wait.type, "since_s": wait.since_s}
        self._teller.tell(
            "wait", [wait.number, {**told, "lasted_s": lasted_s, "place": wait.place}]
        )


@dataclass
class Slow:
    """A line at which callbacks let time pass; see `grader.recording.conduct.Slow`."""

    number: int
    place: dict[str, Any]
    longest_s: float = 0.0
    times: int = 0
    told: tuple[int, float] = (0, 0.0)


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
            slow = self._slow[where] = Slow(len(self._slow), self._teller.line(*where))
        slow.times += 1
        slow.longest_s = max(slow.longest_s, total_s)
        if slow.times >= STEP * slow.told[0]:
            self._tell(slow)

    def sum_up(self) -> None:
        """Tell the last figures."""
        for slow in list(self._slow.values()):
            if slow.told != (slow.times, slow.longest_s):
                self._tell(slow, is_last=True)

    def _tell(self, slow: Slow, *, is_last: bool = False) -> None:
        slow.told = slow.times, slow.longest_s
        longest_s = round(slow.longest_s, 9)
        told = {"place": slow.place, "longest_s": longest_s, "times": slow.times}
        self._teller.tell("slow", [slow.number, told], is_last=is_last)


@dataclass
class Timer:
    """A line that makes timers; see `grader.recording.conduct.Timer`."""

    number: int
    place: dict[str, Any]
    period_s: float = 0.0
    times: int = 0
    told: int = 0


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
        timer = self._made.setdefault(where, Timer(len(self._made), place))
        timer.times, timer.period_s = timer.times + 1, period_s
        if timer.times >= STEP * timer.told:
            self._tell(timer)

    def sum_up(self) -> None:
        """Tell the last figures."""
        for timer in list(self._made.values()):
            if timer.told != timer.times:
                self._tell(timer, is_last=True)

    def _tell(self, timer: Timer, *, is_last: bool = False) -> None:
        timer.told = timer.times
        told = {"place": timer.place, "period_s": timer.period_s, "times": timer.times}
        self._teller.tell("timer", [timer.number, told], is_last=is_last)
