"""Looks on while a submission uses rclpy, and tells what a diagnosis wants to know.

For both clocks. What it puts round rclpy's methods calls them as they were called; it waits for
nothing and takes no time of the run, and what goes wrong in here is nobody's business.
"""

from __future__ import annotations

import functools
import inspect
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from types import FrameType
from typing import Any

from grader.run.lockstep import faults
from grader.run.student import telling
from grader.run.student.delays import Callbacks, Waits
from grader.run.student.telling import Line, Teller

#: So many ends and places are told of: `grader.recording.conduct.MOST`.
MOST = 100
#: How often something was used is told at 1, 4, 16, ... times, and at the end.
STEP = 4
#: Modules of rclpy whose ends every node has, without its author's doing.
_EVERY_NODE = frozenset(
    f"rclpy.{name}"
    for name in (
        *("node", "parameter_service", "time_source", "logging_service", "service"),
        *("type_description_service", "lifecycle.node", "action.server"),
    )
)
#: Functions of rclpy's through which somebody makes an end.
_MAKERS = ("create_publisher", "create_subscription", "create_client", "create_lifecycle_publisher")


@dataclass
class End:
    """An end that the submission has made; see `grader.recording.conduct.End`.

    Attributes:
        number: in the order in which they were made.
        name, type: as they are told.
        ask: whether somebody has the other end.
        told: how often it was used when that was told last.
    """

    number: int
    name: str
    type: str
    ask: Callable[[], bool]
    used: int = 0
    is_met: bool = False
    told: tuple[int, bool] = field(default=(0, False))


class Witness:
    """What has been seen of one submission's process."""

    def __init__(self, teller: Teller, is_met: Callable[[str, Any], Callable[[], bool]]) -> None:
        """`is_met`: of a kind of end and rclpy's object for it, what tells `End.is_met`."""
        self._teller = teller
        self._is_met = is_met
        self._ends: list[End] = []
        self._has_ended = False
        self.waits = Waits(teller)
        self.callbacks = Callbacks(teller)

    # What rclpy's objects do ------------------------------------------------------------------

    def made(self, kind: str, entity: Any, name: str, interface: type) -> None:
        """The program, or a library of its, has made an end."""
        frame = _maker(sys._getframe(2))
        if frame is None or len(self._ends) >= MOST:
            return
        name, ros_type = name[: telling.LONGEST], _ros_type(interface)
        end = End(len(self._ends), name, ros_type, self._is_met(kind, entity))
        entity._witnessed = end
        self._ends.append(end)
        place = self._teller.place(frame)
        told = {"kind": kind, "name": name, "type": ros_type}
        self._teller.tell("end", {**told, "place": place})

    def used(self, entity: Any) -> None:
        """A message was sent or received, or a request sent."""
        end: End | None = getattr(entity, "_witnessed", None)
        if end is None:
            return
        end.used += 1
        if end.used >= STEP * end.told[0]:
            self._tell_of(end)

    def _tell_of(self, end: End, *, is_last: bool = False) -> None:
        end.is_met = end.is_met or bool(end.ask())
        if end.told != (end.used, end.is_met):
            end.told = end.used, end.is_met
            self._teller.tell("used", [end.number, end.used, end.is_met], is_last=is_last)

    def look_for_others(self) -> None:
        """Ask of each end whether somebody has the other one, now that something may have come."""
        for end in list(self._ends):
            if not end.is_met:
                _quietly(self._tell_of, end)
        _quietly(self.waits.look)

    def spins(self) -> None:
        """An executor is spun for the first time."""
        self._teller.tell("spun", self._teller.now_s())

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

    def raised(self, error: BaseException) -> None:
        """An exception has ended the program, before our frames are taken out of its traceback."""
        if isinstance(error, SystemExit) and not error.code:
            return
        lines = telling.trace(error)
        at = self._teller.own(lines)
        place = self._teller.line(lines[at][0].f_code, lines[at][1]) if at >= 0 else None
        if at < 0 and isinstance(error, SyntaxError):
            place = self._of_syntax(error)
        text = str(error.code) if isinstance(error, SystemExit) else _text(error)
        kind = type(error).__name__[: telling.LONGEST]
        told = {"type": kind, "text": text[: telling.LONGEST], "time_s": self._teller.now_s()}
        self._end("raised", {**told, "place": place})

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
            self._end("returned", self._teller.now_s())
        else:
            now_s = self._teller.now_s()
            told = {"type": "SystemExit", "text": str(code), "time_s": now_s, "place": None}
            self._end("raised", told)

    def _end(self, what: str, value: object) -> None:
        """The first of these is how it has ended."""
        if not self._has_ended:
            self._has_ended = True
            self._teller.tell(what, value, is_last=True)
        self.sum_up()

    def sum_up(self) -> None:
        """Tell the last figures, where this is the end."""
        for end in self._ends:
            self._tell_of(end, is_last=True)
        self.waits.look(is_last=True)
        self.callbacks.sum_up()


def install(witness: Witness) -> None:
    """Have rclpy's objects tell; rclpy is imported by now, or will be with `rclpy.node`."""
    import rclpy.client
    import rclpy.executors
    import rclpy.publisher
    import rclpy.subscription
    import rclpy.task

    publisher, client = rclpy.publisher.Publisher, rclpy.client.Client
    subscription, executor = rclpy.subscription.Subscription, rclpy.executors.Executor

    _after(publisher, "__init__", lambda self, _: witness.made(
        "publisher", self, self.topic_name, self.msg_type))  # fmt: skip
    _after(subscription, "__init__", lambda self, _: witness.made(
        "subscription", self, self.topic_name, self.msg_type))  # fmt: skip
    _after(client, "__init__", lambda self, _: witness.made(
        "client", self, self.handle.service_name, self.srv_type))  # fmt: skip
    _after(publisher, "publish", lambda self, _: witness.used(self))
    _after(client, "call_async", lambda self, future: _asked(witness, self, future))
    _awaits(witness, client, "wait_for_service", lambda self, _: self, lambda _, is_ready: is_ready)
    # what virtual time has put round it would take time
    is_done = inspect.unwrap(rclpy.task.Future.done)
    _awaits(witness, executor, "spin_until_future_complete", _first, lambda it, _: is_done(it))
    _watch_callbacks(witness, rclpy.task.Task)

    take, look = executor._take_subscription, executor.wait_for_ready_callbacks

    @functools.wraps(take)
    def taken(self: Any, subscription: Any) -> Any:
        found = take(self, subscription)
        if found is not None:
            _quietly(witness.used, subscription)
        return found

    @functools.wraps(look)
    def first_look(self: Any, *args: Any, **kwargs: Any) -> Any:
        executor.wait_for_ready_callbacks = look
        _quietly(witness.spins)
        return look(self, *args, **kwargs)

    executor._take_subscription = taken
    executor.wait_for_ready_callbacks = first_look


def install_actions(witness: Witness) -> None:
    """The same for action clients; `rclpy.action.client` is imported by now."""
    from rclpy.action.client import ActionClient

    _after(ActionClient, "__init__", lambda self, _: witness.made(
        *("action_client", self, self._node.resolve_service_name(self._action_name)),
        self._action_type))  # fmt: skip
    _after(ActionClient, "send_goal_async", lambda self, _: witness.used(self))
    _awaits(witness, ActionClient, "wait_for_server", lambda self, _: self, lambda _, there: there)


def _after(owner: Any, name: str, look: Callable[[Any, Any], None]) -> None:
    """Have somebody look after each call of a method, at whose it is and what it has returned."""
    method = getattr(owner, name)

    @functools.wraps(method)
    def called(self: Any, *args: Any, **kwargs: Any) -> Any:
        returned = method(self, *args, **kwargs)
        _quietly(look, self, returned)
        return returned

    setattr(owner, name, called)


def _asked(witness: Witness, client: Any, future: Any) -> None:
    """A request was sent; whoever waits for this future waits for the service."""
    witness.used(client)
    future._witnessed = client._witnessed


def _first(_: Any, args: tuple[Any, ...]) -> Any:
    return args[0]


def _awaits(
    witness: Witness,
    owner: Any,
    name: str,
    whose: Callable[[Any, tuple[Any, ...]], Any],
    has_come: Callable[[Any, Any], bool],
) -> None:
    """Have a method tell for how long it waits.

    Args:
        whose: of its object and arguments, what knows the end that is waited for.
        has_come: of that and what the method returns, whether it has waited with success.
    """
    method = getattr(owner, name)

    @functools.wraps(method)
    def awaited(self: Any, *args: Any, **kwargs: Any) -> Any:
        waiter = _quietly(whose, self, args or tuple(kwargs.values()))
        end: End | None = getattr(waiter, "_witnessed", None)
        if end is None:
            return method(self, *args, **kwargs)
        wait = _quietly(witness.waits.since, end.name, end.type)
        returned = method(self, *args, **kwargs)
        _quietly(lambda: witness.waits.over(wait, has_come=bool(has_come(waiter, returned))))
        return returned

    setattr(owner, name, awaited)


def _watch_callbacks(witness: Witness, task: Any) -> None:
    """Have the tasks that an executor runs tell when they begin and end."""
    run, callbacks = task.__call__, witness.callbacks

    @functools.wraps(run)
    def call(self: Any) -> Any:
        lines = callbacks.begin()
        if lines is None:
            return run(self)
        try:
            return run(self)
        finally:
            _quietly(callbacks.end, lines)

    task.__call__ = call


def _quietly(look: Callable[..., Any], *args: Any) -> Any:
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


def _text(error: BaseException) -> str:
    try:
        return str(error)
    except Exception:
        return ""
