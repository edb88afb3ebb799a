"""What a submission's process has told of itself: evidence about the submission, and nothing else.

Who writes such a program may have it tell anything. A diagnosis looks at it; no verdict, no
outcome and no point ever does.

Times are those of the clock that the run lived by [s], from the start of the submission's process.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any, Literal, Self, get_args

from grader.text import one_line, without_controls

#: So many of a kind are kept; what comes later is not.
MOST = 100
#: So many times of one end the line changes that it is used at.
MOST_SENT = 200
#: So many characters of a text.
LONGEST = 300

EndKind = Literal["subscription", "publisher", "client", "action_client"]
StopKind = Literal["callback", "call", "loop", "init", "spin", "going"]
SlipKind = Literal[
    "unread",
    "local",
    "global",
    "uncalled",
    "method",
    "without_self",
    "called",
    "class",
    "unsent",
    "beside",
]


@dataclass(frozen=True)
class Place:
    """A line of the submission's own files.

    Attributes:
        file: relative to what was handed in.
        function: that the line is in; '' for none.
        text: the line as it stands there, without the blanks round it.
    """

    file: str
    line: int
    function: str = ""
    text: str = ""


@dataclass(frozen=True)
class Sent:
    """Messages or requests that were sent one after another from one line.

    Attributes:
        line: which of the end's lines, from 0.
        times: how many.
    """

    line: int
    times: int


@dataclass(frozen=True)
class End:
    """One end of a topic, service or action that the submission has made.

    Attributes:
        name: with its namespace, after remapping.
        type: as 'geometry_msgs/msg/Twist'.
        is_met: whether anybody else had the other end of it, at the end of the run.
        used: how many messages it has sent, received, or requests sent; of a process that was ended
            by force, so many at least.
        place: where it was made.
        used_at: where it was used first, to send something.
        lines: from where it was used to send something.
        sent: from which of them what was sent, in order, from the first on; all of it is there only
            if these are as many as were `used`.
    """

    kind: EndKind
    name: str
    type: str
    is_met: bool
    used: int
    place: Place | None = None
    used_at: Place | None = None
    lines: tuple[Place, ...] = ()
    sent: tuple[Sent, ...] = ()


@dataclass(frozen=True)
class Wait:
    """A wait for a service, an action server or a message that lasted.

    Attributes:
        name, type: of what was waited for.
        since_s, lasted_s: None: until the end.
    """

    name: str
    type: str
    since_s: float
    lasted_s: float | None
    place: Place | None = None


@dataclass(frozen=True)
class Slow:
    """A callback that let time pass: the node could do nothing else meanwhile.

    Attributes:
        place: the line in it that took longest.
        longest_s, times: how long at most, and how often it let more than a tick pass.
    """

    place: Place
    longest_s: float
    times: int


@dataclass(frozen=True)
class Timer:
    """A line that makes a timer.

    Attributes:
        period_s: of the last that it has made.
        times: how many it has made; of a process that was ended by force, so many at least.
    """

    place: Place
    period_s: float
    times: int


@dataclass(frozen=True)
class Caught:
    """An exception of a callback that did not end the program.

    Attributes:
        type, text: as in `Raised`.
        time_s: when it was seen first.
        times: how often it was seen; not every call of a callback is looked at.
        place: the last line of the submission's own that it came from.
        by: the `except` in the callback that caught it; None: it has left the callback.
    """

    type: str
    text: str
    time_s: float
    times: int
    place: Place
    by: Place | None = None


@dataclass(frozen=True)
class Slip:
    """What a look at the source shows: nothing wrong by itself, and seldom what was meant.

    Attributes:
        kind: `unread` - self.NAME is set outside of __init__ and never read, NEAR is a little
            different and read; `local` - NAME is set in a function and not read there, NEAR
            (self.NAME, or NAME of the module) is meant; `global` - NAME of the module is set and
            read in a function, without `global`; `uncalled` - the method or function NAME stands
            there without its brackets; `method` - self.NAME is set, and is a method, too;
            `without_self` - the method NAME has no self; `called` - what was to be handed over to
            NEAR is called at once; `class` - the class NAME is handed over to NEAR, not what is
            made of it; `unsent` - a request of NAME is made, and nothing ever calls a service;
            `beside` - the module NAME that is not found lies beside, and its name is NEAR.
    """

    kind: SlipKind
    name: str
    near: str
    place: Place


@dataclass(frozen=True)
class Stop:
    """Where the program was when it went no further, or the run ended.

    Attributes:
        kind: `callback` - it waits in a callback for what only another could bring; `call` - it
            waits in a call while nobody spins; `loop` - it computes without end. At the end of a
            run, of its main thread: `init` - it was still in an `__init__`; `going` - it was in a
            loop of its own, and did not just spin.
        call: the last function of a library that it was in, as 'Client.call'; '' for none.
    """

    kind: StopKind
    time_s: float
    call: str = ""
    place: Place | None = None


@dataclass(frozen=True)
class Raised:
    """The exception that ended the program or its thread that spun; or a signal for a mistake in C.

    Attributes:
        type: as 'ZeroDivisionError'; 'SIGABRT' for a signal.
        place: the last line of the submission's own; None where there is none.
    """

    type: str
    text: str
    time_s: float
    place: Place | None = None


@dataclass(frozen=True)
class Conduct:
    """All of it.

    Attributes:
        is_told: whether anything was told at all; False for controllers in other languages.
        ends: in the order in which they were made.
        spun_s: when an executor was first spun; None for never.
        waits: services and the like that were waited for longer than a second, or in vain.
        slow: callbacks that let time pass.
        timers: the lines that have made timers, in the order in which they came.
        caught: exceptions of callbacks that the program went on after.
        slips: in the files that it has loaded.
        stop: where it got stuck.
        raised: what ended it; of a thread that spun, the program may have gone on without it.
        returned_s: when its program came to its end by itself, without an error.
    """

    is_told: bool = False
    ends: tuple[End, ...] = ()
    spun_s: float | None = None
    waits: tuple[Wait, ...] = ()
    slow: tuple[Slow, ...] = ()
    timers: tuple[Timer, ...] = ()
    caught: tuple[Caught, ...] = ()
    slips: tuple[Slip, ...] = ()
    stop: Stop | None = None
    raised: Raised | None = None
    returned_s: float | None = None

    def to_json(self) -> dict[str, Any]:
        """As `from_json` takes it."""
        return asdict(self)

    @classmethod
    def from_json(cls, data: Any) -> Self:
        """What somebody has told, whoever that is.

        Raises:
            ValueError: it has another form, or is longer than it may be.
        """
        data = _object(data, cls)
        return cls(
            _is(data["is_told"], bool),
            tuple(_end(each) for each in _list(data["ends"])),
            _perhaps_time(data["spun_s"]),
            tuple(_wait(each) for each in _list(data["waits"])),
            tuple(_slow(each) for each in _list(data["slow"])),
            tuple(_timer(each) for each in _list(data["timers"])),
            tuple(_caught(each) for each in _list(data["caught"])),
            tuple(_slip(each) for each in _list(data["slips"])),
            None if data["stop"] is None else _stop(data["stop"]),
            None if data["raised"] is None else _raised(data["raised"]),
            _perhaps_time(data["returned_s"]),
        )


def _end(data: Any) -> End:
    data = _object(data, End)
    lines = tuple(map(_place, _list(data["lines"])))
    return End(
        _one_of(data["kind"], EndKind),
        _text(data["name"]),
        _text(data["type"]),
        _is(data["is_met"], bool),
        _count(data["used"]),
        _perhaps_place(data["place"]),
        _perhaps_place(data["used_at"]),
        lines,
        tuple(_sent(each, len(lines)) for each in _list(data["sent"], MOST_SENT)),
    )


def _sent(data: Any, lines: int) -> Sent:
    data = _object(data, Sent)
    line = _count(data["line"])
    if line >= lines:
        raise ValueError(f"expected one of {lines} lines, found {line!r:.80}")
    return Sent(line, _count(data["times"]))


def _wait(data: Any) -> Wait:
    data = _object(data, Wait)
    lasted_s, place = _perhaps_time(data["lasted_s"]), _perhaps_place(data["place"])
    return Wait(_text(data["name"]), _text(data["type"]), _time(data["since_s"]), lasted_s, place)


def _slow(data: Any) -> Slow:
    data = _object(data, Slow)
    return Slow(_place(data["place"]), _time(data["longest_s"]), _count(data["times"]))


def _timer(data: Any) -> Timer:
    data = _object(data, Timer)
    return Timer(_place(data["place"]), _time(data["period_s"]), _count(data["times"]))


def _caught(data: Any) -> Caught:
    data = _object(data, Caught)
    place, by = _place(data["place"]), _perhaps_place(data["by"])
    time_s, times = _time(data["time_s"]), _count(data["times"])
    return Caught(_text(data["type"]), _text(data["text"]), time_s, times, place, by)


def _slip(data: Any) -> Slip:
    data = _object(data, Slip)
    kind = _one_of(data["kind"], SlipKind)
    return Slip(kind, _text(data["name"]), _text(data["near"]), _place(data["place"]))


def _stop(data: Any) -> Stop:
    data = _object(data, Stop)
    kind, place = _one_of(data["kind"], StopKind), _perhaps_place(data["place"])
    return Stop(kind, _time(data["time_s"]), _text(data["call"]), place)


def _raised(data: Any) -> Raised:
    data = _object(data, Raised)
    place = _perhaps_place(data["place"])
    return Raised(_text(data["type"]), _text(data["text"]), _time(data["time_s"]), place)


def _perhaps_place(data: Any) -> Place | None:
    return None if data is None else _place(data)


def _place(data: Any) -> Place:
    data = _object(data, Place)
    line, function = _count(data["line"]), _text(data["function"])
    file = _text(data["file"])
    if file.startswith("/") or ".." in file.split("/"):
        raise ValueError(f"expected a file of the submission's own, found {file!r:.80}")
    return Place(file, line, function, _text(data["text"]))


def _object(data: Any, kind: type[Any]) -> Mapping[str, Any]:
    wanted = {field.name for field in fields(kind)}
    if not isinstance(data, dict) or data.keys() != wanted:
        raise ValueError(f"expected an object of {', '.join(sorted(wanted))}, found {data!r:.80}")
    return data


def _list(data: Any, most: int = MOST) -> list[Any]:
    if not isinstance(data, list) or len(data) > most:
        raise ValueError(f"expected a list of {most} at most, found {data!r:.80}")
    return data


def _text(data: Any) -> str:
    """In one line, and without what a terminal, a log or XML would stumble over."""
    text: str = _is(data, str)
    if len(text) > LONGEST:
        raise ValueError(f"expected {LONGEST} characters at most, found {len(text)}")
    return without_controls(one_line(text), "?")


def _one_of(data: Any, kinds: Any) -> Any:
    if data not in get_args(kinds):
        raise ValueError(f"expected one of {', '.join(get_args(kinds))}, found {data!r:.80}")
    return data


def _count(data: Any) -> int:
    number: int = _is(data, int)
    if not 0 <= number < 2**53:
        raise ValueError(f"expected a count, found {number!r:.80}")
    return number


def _perhaps_time(data: Any) -> float | None:
    return None if data is None else _time(data)


def _time(data: Any) -> float:
    if type(data) not in (int, float) or not 0 <= data < math.inf:
        raise ValueError(f"expected seconds, found {data!r:.80}")
    return float(data)


def _is(data: Any, kind: type[Any]) -> Any:
    if type(data) is not kind:
        raise ValueError(f"expected {kind.__name__}, found {data!r:.80}")
    return data
