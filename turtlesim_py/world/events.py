"""What an arena reports to its listeners: inputs, log lines and the progress of rotation goals.

An input is an `Event`, one frozen dataclass a kind, with the kind's `op` and fields. Its JSON form
is the scenario's, and only `to_json` and `from_json` know it: there, not-a-number and the
infinities are the strings "nan", "inf" and "-inf", and whole numbers have no decimal point; in an
event they are floats.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, fields
from typing import Any, ClassVar, Final, Literal, TypeVar

from turtlesim_py.world.floats import json_number

Vector = tuple[float, float, float]
#: What a rotation goal is known by: bytes from ROS, anything else from a scenario.
GoalId = object
Severity = Literal["INFO", "WARN", "ERROR"]
GoalStatus = Literal["SUCCEEDED", "CANCELED", "ABORTED"]


class EventError(ValueError):
    """JSON that describes no event; the text names what is missing or wrong."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Event:
    """An input that takes effect with tick `tick` (1, 2, ...)."""

    op: ClassVar[str]

    tick: int

    def __init_subclass__(cls, op: str = "") -> None:
        cls.op = op or cls.op  # `slots` makes each class a second time, without the keyword


@dataclass(frozen=True, slots=True, kw_only=True)
class CmdVel(Event, op="cmd_vel"):
    """A velocity command: linear [m/s], angular [rad/s]."""

    turtle: str = "turtle1"
    linear: Vector
    angular: Vector


@dataclass(frozen=True, slots=True, kw_only=True)
class SetPen(Event, op="set_pen"):
    """A change of the pen: colour and width [px], each 0-255; `off` other than 0 lifts it."""

    turtle: str = "turtle1"
    r: int
    g: int
    b: int
    width: int
    off: int


@dataclass(frozen=True, slots=True, kw_only=True)
class TeleportAbsolute(Event, op="teleport_absolute"):
    """A jump to x, y [m] with heading theta [rad]."""

    turtle: str = "turtle1"
    x: float
    y: float
    theta: float


@dataclass(frozen=True, slots=True, kw_only=True)
class TeleportRelative(Event, op="teleport_relative"):
    """A turn by `angular` [rad], then a jump ahead by `linear` [m]."""

    turtle: str = "turtle1"
    linear: float
    angular: float


@dataclass(frozen=True, slots=True, kw_only=True)
class RotateAbsolute(Event, op="rotate_absolute"):
    """A rotation goal towards heading theta [rad]."""

    turtle: str = "turtle1"
    theta: float
    id: GoalId


@dataclass(frozen=True, slots=True, kw_only=True)
class Cancel(Event, op="cancel"):
    """A request to end a rotation goal."""

    id: GoalId


@dataclass(frozen=True, slots=True, kw_only=True)
class Spawn(Event, op="spawn"):
    """A new turtle at x, y [m] with heading theta [rad]; an empty name gets one."""

    x: float
    y: float
    theta: float
    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Kill(Event, op="kill"):
    """The end of a turtle."""

    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Clear(Event, op="clear"):
    """The drawing is wiped."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reset(Event, op="reset"):
    """Everything starts again."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SetParameter(Event, op="param"):
    """A parameter is to be set; `value` is a bool, int, float or str."""

    name: str
    value: bool | int | float | str
    #: in JSON only: a whole number that is meant as a double
    double: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Snapshot(Event, op="snapshot"):
    """Of a scenario: keep the drawing as it is after this tick."""

    name: str


@dataclass(frozen=True, slots=True, kw_only=True)
class SnapshotNow(Event, op="snapshot_now"):
    """Of a scenario: keep the drawing as it is now, before this tick."""

    name: str


@dataclass(frozen=True, slots=True)
class LogLine:
    """A line that the original writes to its log."""

    severity: Severity
    text: str


@dataclass(frozen=True, slots=True)
class GoalFeedback:
    """A rotation goal still has `remaining_rad` to turn."""

    turtle: str
    goal_id: object
    remaining_rad: float


@dataclass(frozen=True, slots=True)
class GoalResult:
    """A rotation goal ended; `delta_rad` is start minus end, the original's sign."""

    turtle: str
    goal_id: object
    status: GoalStatus
    delta_rad: float


#: An event is reported before it has any effect.
Notice = Event | LogLine | GoalFeedback | GoalResult

KINDS: Final[Mapping[str, type[Event]]] = {
    kind.op: kind
    for kind in (
        *(CmdVel, SetPen, TeleportAbsolute, TeleportRelative, RotateAbsolute, Cancel),
        *(Spawn, Kill, Clear, Reset, SetParameter, Snapshot, SnapshotNow),
    )
}
SomeEvent = TypeVar("SomeEvent", bound=Event)


def to_json(event: Event) -> dict[str, Any]:
    """Return the event as in a scenario: `{"tick", "op", ...}` in the order of the fields."""
    words: dict[str, Any] = {"tick": event.tick, "op": event.op}
    for name in _FIELDS[event.op]:
        words[name] = _json_value(getattr(event, name))
    if isinstance(event, SetParameter) and not event.double:
        del words["double"]
    return words


def from_json(words: Mapping[str, Any]) -> Event:
    """Parse an event of a scenario.

    Raises:
        EventError: it is none.
    """
    tick, op = words.get("tick"), words.get("op")
    if type(tick) is not int:
        raise EventError(f"'tick' must be a whole number, found {tick!r}")
    kind = KINDS.get(op) if isinstance(op, str) else None
    if kind is None:
        raise EventError(f"unknown op {op!r}")
    values: dict[str, Any] = {"tick": tick}
    for name, (read, is_needed) in _FIELDS[kind.op].items():
        if name in words:
            try:
                values[name] = read(words[name])
            except (TypeError, ValueError, OverflowError) as error:
                raise EventError(f"{name}: {error}") from None
        elif is_needed:
            raise EventError(f"no field {name!r}")
    if kind is SetParameter and values.get("double"):
        values["value"] = _number(values["value"])
    return kind(**values)


def _json_value(value: object) -> Any:
    """Return a value as JSON can hold it: goal ids of ROS as hexadecimal."""
    if isinstance(value, float):
        return json_number(value, 17)
    if isinstance(value, tuple):
        return [json_number(number, 17) for number in value]
    return value.hex() if isinstance(value, bytes) else value


def _number(value: Any) -> float:
    if isinstance(value, bool):
        raise ValueError(f"expected a number, found {value!r}")
    return float(value)


def _vector(value: Any) -> Vector:
    if not isinstance(value, list | tuple) or len(value) != 3:
        raise ValueError(f"expected three numbers, found {value!r}")
    x, y, z = map(_number, value)
    return x, y, z


def _whole(value: Any) -> int:
    if not isinstance(value, int | float) or value != int(value):
        raise ValueError(f"expected a whole number, found {value!r}")
    return int(value)


def _text(value: Any) -> str:
    if not isinstance(value, str):
        raise ValueError(f"expected a text, found {value!r}")
    return value


_READERS: Final[Mapping[str, Callable[[Any], Any]]] = {
    "str": _text,
    "int": _whole,
    "float": _number,
    "bool": bool,
    "Vector": _vector,
}
#: op -> its fields but the tick, in order: how each is read from JSON, and whether it is needed.
_FIELDS: Final = {
    kind.op: {
        field.name: (_READERS.get(str(field.type), lambda it: it), field.default is MISSING)
        for field in fields(kind)
        if field.name != "tick"
    }
    for kind in KINDS.values()
}
