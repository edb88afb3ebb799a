"""Looks on while a submission uses rclpy, and tells what a diagnosis wants to know.

For both clocks; `hooks` has rclpy's objects call it. It waits for nothing and takes no time of the
run, and what goes wrong in here is nobody's business.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from types import CodeType, FrameType
from typing import Any

from grader.run.lockstep import faults
from grader.run.student import loops, telling
from grader.run.student.catching import Catching
from grader.run.student.delays import Callbacks, Timers, Waits
from grader.run.student.sending import Sending
from grader.run.student.telling import Line, Teller

#: So many ends and places are told of: `grader.recording.conduct.MOST`.
MOST = 100
#: Modules of rclpy whose ends every node has, without its author's doing.
_EVERY_NODE = frozenset(
    f"rclpy.{name}"
    for name in (
        *("node", "parameter_service", "time_source", "logging_service", "service"),
        *("type_description_service", "lifecycle.node", "action.server"),
    )
)
#: Functions of rclpy's through which somebody makes an end.
_MAKERS = (
    "create_timer",
    "create_publisher",
    "create_subscription",
    "create_client",
    "create_lifecycle_publisher",
)


@dataclass
class End:
    """An end that the submission has made; see `grader.recording.conduct.End`.

    Attributes:
        name, type, place, used_at: as they are told.
        ask: whether somebody has the other end.
    """

    kind: str
    name: str
    type: str
    place: dict[str, Any] | None
    ask: Callable[[], bool]
    used: int = 0
    is_met: bool = False
    used_at: dict[str, Any] | None = None
    sending: Sending = field(default_factory=Sending)


class Witness:
    """What has been seen of one submission's process."""

    def __init__(self, teller: Teller, is_met: Callable[[str, Any], Callable[[], bool]]) -> None:
        """`is_met`: of a kind of end and rclpy's object for it, what tells `End.is_met`."""
        self._teller = teller
        self._is_met = is_met
        self._ends: list[End] = []
        self._has_ended = False
        #: how it ended, when it was first spun: what is told of once
        self._once: dict[str, Any] = dict.fromkeys(("spun_s", "stop", "raised", "returned_s"))
        self._is_blind = False
        #: where something that cannot be called was first given for a callback
        self._uncallable: dict[str, Any] | None = None
        self.waits = Waits(teller)
        self.callbacks = Callbacks(teller)
        self.timers = Timers(teller)
        self.catching = Catching(teller)
        teller.account.tell = self._tell
        teller.account.write()

    # What rclpy's objects do ------------------------------------------------------------------

    def made(self, kind: str, entity: Any, name: str, interface: type) -> None:
        """The program, or a library of its, has made an end."""
        frame = _maker(sys._getframe(2))
        if frame is None or len(self._ends) >= MOST:
            return
        name, ros_type = name[: telling.LONGEST], _ros_type(interface)
        place = self._teller.place(frame)
        end = End(kind, name, ros_type, place, self._is_met(kind, entity))
        entity._witnessed = end
        self._ends.append(end)
        self._teller.account.write()

    def is_given(self, callback: Any) -> None:
        """A timer or a future is to call this."""
        if self._uncallable is None and not callable(callback):
            self._uncallable = self._teller.place(sys._getframe())

    def has_timer(self, timer: Any) -> None:
        """The program has made a timer."""
        frame = sys._getframe(2)
        if _maker(frame) is not None:
            self.timers.made(self._teller.place(frame), timer.timer_period_ns / 1e9)

    def used(self, entity: Any, *, is_sent: bool = False) -> None:
        """A message was sent or received, or a request sent."""
        end: End | None = getattr(entity, "_witnessed", None)
        if end is None:
            return
        if is_sent:
            frame = self._teller.own_frame(sys._getframe())
            if end.used == 0 and frame is not None:
                end.used_at = self._teller.line(frame.f_code, frame.f_lineno)
            end.sending.count(frame)
        self._count(end)

    def heard(self, topic: str) -> None:
        """A message has come to the last subscription to a topic, which is no more."""
        end = next((end for end in reversed(self._ends) if end.name == topic), None)
        if end is not None:
            self._count(end)

    def _count(self, end: End) -> None:
        end.used += 1
        self._teller.account.changed()

    def look_for_others(self) -> None:
        """Ask of each end whether somebody has the other one, now that something may have come."""
        before = [end.is_met for end in self._ends]
        self._ask_of_ends()
        if before != [end.is_met for end in self._ends]:
            self._teller.account.changed()
        quietly(self.waits.look)

    def _ask_of_ends(self) -> None:
        for end in list(self._ends):
            end.is_met = end.is_met or bool(quietly(end.ask))

    def is_blind(self) -> None:
        """Nothing that was told may be believed: not all of it is seen."""
        self._is_blind = True
        self._teller.account.write()

    def _tell(self) -> dict[str, Any]:
        """All of it, as `grader.run.evidence` reads it."""
        self._ask_of_ends()
        return {
            "is_blind": self._is_blind,
            "ends": [self._told_of(end) for end in list(self._ends)],
            "waits": self.waits.told(),
            "slow": self.callbacks.told(),
            "timers": self.timers.told(),
            "caught": self.catching.told(),
            **self._once,
        }

    def _told_of(self, end: End) -> dict[str, Any]:
        names = ("kind", "name", "type", "is_met", "used", "place", "used_at")
        return {
            **{name: getattr(end, name) for name in names},
            "lines": [self._teller.line(*line) for line in end.sending.lines],
            "sent": [{"line": line, "times": times} for line, times in end.sending.sent],
        }

    def spins(self) -> None:
        """An executor is spun for the first time."""
        self._tell_once("spun_s", self._teller.now_s())

    # How it ends ------------------------------------------------------------------------------

    def stuck(self, kind: str, lines: list[Line]) -> None:
        """The program goes no further; `lines`: where it is, outermost first."""
        at = self._teller.own(lines)
        if at < 0:
            return
        place, call = (
            self._teller.line(lines[at][0].f_code, lines[at][1]),
            telling.called(lines, at),
        )
        told = {"kind": kind, "time_s": self._teller.now_s(), "call": call, "place": place}
        self._end("stop", told)

    def over(self, main: int) -> None:
        """The run is over, and the program would have gone on; `main`: its main thread."""
        if not self._has_ended:
            quietly(self._tell_where, main)
        self.sum_up()

    def _tell_where(self, thread: int) -> None:
        lines = telling.stack(sys._current_frames().get(thread))[::-1]
        found = loops.standing([self._seen(*line) for line in lines])
        if found is not None:
            place = self._teller.line(lines[found.at][0].f_code, found.line)
            told = {"kind": found.kind, "time_s": self._teller.now_s(), "call": ""}
            self._tell_once("stop", {**told, "place": place})

    def _seen(self, frame: FrameType, line: int) -> loops.Seen:
        file, is_own = frame.f_code.co_filename, self._teller.is_own(frame.f_code.co_filename)
        source = self._teller.source(file) if is_own else None
        return loops.Seen(file, frame.f_code.co_name, line, source)

    def thread_raised(self, error: BaseException) -> None:
        """An exception has ended a thread: the program goes on, but not what that thread spun."""
        lines = telling.trace(error.__traceback__)
        if any(frame.f_globals.get("__name__") == "rclpy.executors" for frame, _ in lines):
            self._tell_once("raised", self._of_error(error, lines))

    def raised(self, error: BaseException) -> None:
        """An exception has ended the program, before our frames are taken out of its traceback."""
        if not isinstance(error, SystemExit) or error.code:
            self._end("raised", self._of_error(error, telling.trace(error.__traceback__)))

    def _of_error(self, error: BaseException, lines: list[Line]) -> dict[str, Any]:
        at = self._teller.own(lines)
        place = self._teller.line(lines[at][0].f_code, lines[at][1]) if at >= 0 else None
        if at < 0 and isinstance(error, SyntaxError):
            place = self._of_syntax(error)
        if isinstance(error, TypeError) and at < len(lines) - 1:
            place = self._of_callback(error, lines[-1][0]) or place
        text = str(error.code) if isinstance(error, SystemExit) else telling.text(error)
        kind = type(error).__name__[: telling.LONGEST]
        told = {"type": kind, "text": text[: telling.LONGEST], "time_s": self._teller.now_s()}
        return {**told, "place": place}

    def _of_callback(self, error: TypeError, frame: FrameType) -> dict[str, Any] | None:
        """The callback that rclpy could not call: its `def`, or where it was given what is none."""
        if frame.f_globals.get("__name__") not in ("rclpy.executors", "rclpy.task"):
            return None
        if "object is not callable" in telling.text(error):
            return self._uncallable
        called = frame.f_locals.get("callback")
        code = getattr(getattr(called, "__func__", called), "__code__", None)
        if not isinstance(code, CodeType) or not self._teller.is_own(code.co_filename):
            return None
        is_it = f"{code.co_name}() " in telling.text(error)
        return self._teller.line(code, code.co_firstlineno) if is_it else None

    def _of_syntax(self, error: SyntaxError) -> dict[str, Any] | None:
        if not error.filename or not self._teller.is_own(error.filename):
            return None
        file, text = error.filename.removeprefix(self._teller.root), (error.text or "").strip()
        return {
            "file": file[: telling.LONGEST],
            "line": error.lineno or 0,
            "function": "",
            "text": text[: telling.LONGEST],
        }

    def returned(self, code: int) -> None:
        """The program has come to its end by itself."""
        if code == 0:
            self._end("returned_s", self._teller.now_s())
        else:
            now_s = self._teller.now_s()
            told = {"type": "SystemExit", "text": str(code), "time_s": now_s, "place": None}
            self._end("raised", told)

    def _end(self, what: str, value: object) -> None:
        """The first of these is how it has ended."""
        if not self._has_ended:
            self._has_ended = True
            self._tell_once(what, value)
        self.sum_up()

    def _tell_once(self, what: str, value: object) -> None:
        if self._once[what] is None:
            self._once[what] = value
            self._teller.account.write()

    def sum_up(self) -> None:
        """This is the end: the account is the last one."""
        quietly(self.waits.look)
        self._teller.account.write(is_last=True)


def quietly(look: Callable[..., Any], *args: Any) -> Any:
    """What goes wrong here is not the program's concern."""
    try:
        return look(*args)
    except Exception:
        return None


def _maker(frame: FrameType | None) -> FrameType | None:
    """Who has made an end; None where every node has it."""
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
    return f"{package}/{kind}/{interface.__name__}"[: telling.LONGEST]
