"""Summarises what a submission's process does, for its account.

Virtual and real time share it; `hooks` has rclpy's objects call it. It waits for nothing, costs no
virtual time, and its errors never reach the program.
"""

from __future__ import annotations

import sys
from _thread import get_ident
from collections.abc import Callable
from dataclasses import dataclass, field
from types import CodeType, FrameType
from typing import Any

from grader.run.lockstep import faults
from grader.run.observe import ending
from grader.run.observe.account import ProcessAccount, quietly
from grader.run.observe.ending import EndWitness, error_row
from grader.run.observe.files import LONGEST, Row, SubmissionFiles
from grader.run.observe.lines import LineMarks

#: The most entries of a kind, as `grader.recording.observations` accepts them.
MOST = 100
#: The most exceptions that leave callbacks.
MOST_CAUGHT = 20
#: The most lines that one end sends from, and changes between them.
MOST_LINES, MOST_CHANGES = 8, 150
#: A successful wait is kept if it takes longer [s].
LONG_S = 1.0
#: The time that a callback may let pass, as publishing does [s]: a tick.
SHORT_S = 0.016
#: Exceptions that end a program or a loop as intended.
NO_ERRORS = ("ExternalShutdownException", "StopIteration")
#: Modules of rclpy whose ends every node has, without its author's doing.
_EVERY_NODE = frozenset(
    f"rclpy.{name}"
    for name in (
        *("node", "parameter_service", "time_source", "logging_service", "service"),
        *("type_description_service", "lifecycle.node", "action.server"),
    )
)
#: Functions of rclpy's with which a program makes an end.
_MAKERS = (
    *("create_timer", "create_publisher", "create_subscription", "create_client"),
    "create_lifecycle_publisher",
)

#: A line of the submission's.
Where = tuple[CodeType, int]


@dataclass
class UsedEnd:
    """An end that the submission has made.

    Attributes:
        row: its entry in the account; see `grader.recording.observations.End`.
        ask: returns whether it has a counterpart.
        lines: the line that has sent -> its index among the row's lines.
    """

    row: Row
    ask: Callable[[], bool]
    lines: dict[Where, int] = field(default_factory=dict)
    _is_full: bool = False

    def sent_from(self, frame: FrameType | None, files: SubmissionFiles) -> None:
        """Count what was sent from this frame's line, in order.

        After None, or too many lines, nothing more is counted: the counted ones stay the first.
        """
        if self._is_full or frame is None:
            self._is_full = True
            return
        where = frame.f_code, frame.f_lineno
        sent = self.row["sent"]
        number = self.lines.get(where, len(self.lines))
        if sent and sent[-1]["line"] == number:
            sent[-1]["times"] += 1
        elif number >= MOST_LINES or len(sent) >= MOST_CHANGES:
            self._is_full = True
        else:
            if where not in self.lines:
                self.lines[where] = number
                self.row["lines"].append(files.row_of(*where))
            sent.append({"line": number, "times": 1})


@dataclass
class OpenWait:
    """A wait for a service, its answer, an action server; failed waits in a row count as one.

    Attributes:
        lasted_s: how long it had lasted when it was last over [s].
        is_worth_it: whether it was long, or failed once.
    """

    name: str
    type: str
    since_s: float
    place: Row | None
    lasted_s: float = 0.0
    goes_on: bool = True
    is_worth_it: bool = False

    def row(self, now_s: float) -> Row | None:
        """Return its entry in the account; None for one that is not worth it."""
        lasts = self.goes_on and now_s - self.since_s > LONG_S
        if not lasts and not self.is_worth_it:
            return None
        return {
            **{"name": self.name, "type": self.type, "since_s": self.since_s},
            **{"lasted_s": None if lasts else self.lasted_s, "place": self.place},
        }


class Witness:
    """Observes one submission's process.

    Attributes:
        ending: observes how it ends.
        lines: notes which of them run.
    """

    def __init__(
        self,
        page: int,
        root: str,
        now_s: Callable[[], float],
        is_met: Callable[[str, Any], Callable[[], bool]],
    ) -> None:
        """Keep the account of a submission.

        Args:
            page: the page of its account; -1 for none.
            root: its folder.
            now_s: the time since the start of this process on the clock of the run [s].
            is_met: makes `UsedEnd.ask` from a kind of end and rclpy's object for it.
        """
        self._files = SubmissionFiles(root)
        self.lines = LineMarks(self._files)
        self._now_s = now_s
        self._is_met = is_met
        self._is_blind = False
        self._ends: list[UsedEnd] = []
        self._waits: list[OpenWait] = []
        #: those that go on, or failed: by what is waited for
        self._open_waits: dict[tuple[str, str], OpenWait] = {}
        #: lines that occur again and again, by their keys
        self._slow: dict[object, Row] = {}
        self._timers: dict[object, Row] = {}
        self._caught: dict[object, Row] = {}
        #: when an executor was first spun
        self._spun_s: float | None = None
        #: thread of a running callback -> for how long each of its lines has waited [s]
        self._running: dict[int, dict[Where, float]] = {}
        self._account = ProcessAccount(page, self._summary)
        self.ending = EndWitness(self._files, self._account, now_s)
        self._account.dump_when_asked()
        self._account.write()

    def _summary(self) -> Row:
        """Return all of it, as `grader.run.evidence` reads it."""
        now_s = self._now_s()
        for end in list(self._ends):
            end.row["is_met"] = end.row["is_met"] or bool(quietly(end.ask))
        waits = sorted(self._waits, key=lambda wait: wait.since_s)
        return {
            "is_blind": self._is_blind,
            "ends": [end.row for end in list(self._ends)],
            "waits": [row for wait in waits if (row := wait.row(now_s))][:MOST],
            "slow": list(self._slow.values()),
            "timers": list(self._timers.values()),
            "caught": list(self._caught.values()),
            "spun_s": self._spun_s,
            "ran": self.lines.rows(),
            **self.ending.row,
        }

    def write(self) -> None:
        """Write the account: counterparts may have come since."""
        self._account.write()

    def discard(self) -> None:
        """Note that the observations are incomplete, so that none of them counts."""
        self._is_blind = True
        self._account.write()

    # What it uses -----------------------------------------------------------------------------

    def made(self, kind: str, entity: Any, name: str, interface: type) -> None:
        """Note an end that the program, or a library of its, has made."""
        frame = _maker(sys._getframe())
        if frame is None or len(self._ends) >= MOST:
            return
        row: Row = {
            **{"kind": kind, "name": name[:LONGEST], "type": _ros_type(interface)},
            **{"is_met": False, "used": 0, "place": self._files.place(frame)},
            **{"used_at": None, "lines": [], "sent": []},
        }
        entity._witnessed = UsedEnd(row, self._is_met(kind, entity))
        self._ends.append(entity._witnessed)
        self._account.write()

    def made_timer(self, timer: Any) -> None:
        """Note a timer of the program; that of a spin with a timeout has no callback."""
        if timer.callback is None:
            return
        frame = _maker(sys._getframe())
        place = self._files.place(frame)
        if frame is not None and place is not None:
            where, period_s = (place["file"], place["line"]), timer.timer_period_ns / 1e9
            row = self._count(self._timers, where, {"place": place, "period_s": period_s})
            if row is not None:
                row["period_s"] = period_s

    def used(self, entity: Any, *, is_sent: bool = False) -> None:
        """Count a message that was sent or received, or a request that was sent."""
        end: UsedEnd | None = getattr(entity, "_witnessed", None)
        if end is None:
            return
        if is_sent:
            frame = self._files.innermost(sys._getframe())
            if end.row["used"] == 0:
                end.row["used_at"] = self._files.place(frame)
            end.sent_from(frame, self._files)
        end.row["used"] += 1
        self._account.changed()

    def heard(self, topic: str) -> None:
        """Count a message of the last subscription to a topic, which was destroyed since."""
        for end in reversed(self._ends):
            if end.row["name"] == topic:
                end.row["used"] += 1
                self._account.changed()
                return

    def spins(self) -> None:
        """Note when an executor first spins."""
        if self._spun_s is None:
            self._spun_s = self._now_s()
            self._account.write()

    # What it waits for ------------------------------------------------------------------------

    def begin_wait(self, end: UsedEnd) -> OpenWait:
        """Begin a wait, or go on with a failed one for the same."""
        key = end.row["name"], end.row["type"]
        wait = self._open_waits.get(key)
        if wait is None:
            place = self._files.place(sys._getframe())
            wait = self._open_waits[key] = OpenWait(*key, self._now_s(), place)
            self._waits.append(wait)
        wait.goes_on = True
        return wait

    def end_wait(self, wait: OpenWait, *, has_come: bool) -> None:
        """End a wait: what was waited for has come, or the program gives up."""
        wait.goes_on, wait.lasted_s = False, self._now_s() - wait.since_s
        if has_come:
            self._open_waits.pop((wait.name, wait.type), None)
        if wait.is_worth_it:
            self._account.changed()
        elif not has_come or wait.lasted_s > LONG_S:
            wait.is_worth_it = True
            self._account.write()
        else:
            self._waits.remove(wait)

    # What its callbacks do --------------------------------------------------------------------

    def begin_callback(self) -> bool:
        """Begin a callback in this thread; return whether it is not within another."""
        is_first = get_ident() not in self._running
        if is_first:
            self._running[get_ident()] = {}
        return is_first

    def end_callback(self, error: BaseException | None) -> None:
        """End the callback of this thread, by an exception or by itself."""
        lines = self._running.pop(get_ident())
        total_s = sum(lines.values())
        if total_s > SHORT_S:
            where, lasted_s = max(lines, key=lambda where: lines[where]), round(total_s, 9)
            new = {"place": self._files.row_of(*where), "longest_s": lasted_s}
            row = self._count(self._slow, where, new)
            if row is not None:
                row["longest_s"] = max(row["longest_s"], lasted_s)
        if isinstance(error, Exception) and type(error).__name__ not in NO_ERRORS:
            last = ending.last_line(self._files.trace(error))
            if last is not None:
                row = error_row(error, self._files.row_of_frame(last), self._now_s())
                self._count(self._caught, (row["type"], last.file, last.line), row, MOST_CAUGHT)

    def waited(self, lasted_s: float) -> None:
        """Count a wait of this thread [s]."""
        lines = self._running.get(get_ident())
        frame = self._files.innermost(sys._getframe()) if lines is not None else None
        if lines is not None and frame is not None:
            where = frame.f_code, frame.f_lineno
            lines[where] = lines.get(where, 0.0) + lasted_s

    def _count(
        self, rows: dict[object, Row], key: object, new: Row, most: int = MOST
    ) -> Row | None:
        """Count one more of a line; return its row, or None where there is no room for it."""
        if key not in rows:
            if len(rows) >= most:
                return None
            rows[key] = {**new, "times": 1}
            self._account.write()
        else:
            rows[key]["times"] += 1
            self._account.changed()
        return rows[key]


def _maker(frame: FrameType | None) -> FrameType | None:
    """Return the frame that has made an end; None where every node has that end."""
    while frame is not None:
        module = str(frame.f_globals.get("__name__", ""))
        if not faults.is_ours(frame.f_code.co_filename) and not (
            module.startswith("rclpy.") and frame.f_code.co_name in _MAKERS
        ):
            return None if module in _EVERY_NODE else frame
        frame = frame.f_back
    return None


def _ros_type(interface: type) -> str:
    package, kind, *_ = (*interface.__module__.split("."), "", "")
    return f"{package}/{kind}/{interface.__name__}"[:LONGEST]
