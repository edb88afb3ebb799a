"""What a submission's process reports about itself, and prints: evidence for a diagnosis alone.

The author of a program may have it report anything. A diagnosis uses it; no verdict, no outcome and
no point ever does.

Times are those of the clock that the run lived by [s], from the start of the submission's process.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import PurePath
from typing import Annotated, Any, Literal, Self

from grader.system.strict_json import Bounds, from_json, not_negative
from grader.text.strings import one_line, without_controls

#: So many characters of a text and entries of a kind are kept; later ones are not. Line breaks and
#: control characters would break a terminal, a log or XML.
STRANGERS = Bounds(300, 100, clean=lambda text: without_controls(one_line(text), "?"))
#: So many times of one end the line changes that it is used at.
MOST_SENT = 200


def _inside_submission(file: str) -> str:
    if file.startswith("/") or ".." in file.split("/"):
        raise ValueError(f"expected a file of the submission's own, found {file!r:.80}")
    return file


File = Annotated[str, _inside_submission]
Count = Annotated[int, not_negative]
Seconds = Annotated[float, not_negative]

EndKind = Literal["subscription", "publisher", "client", "action_client"]
StopKind = Literal["callback", "call", "loop", "init", "spin", "going"]


@dataclass(frozen=True)
class SourceLine:
    """A line of the submission's own files.

    Attributes:
        file: relative to the submission.
        function: that the line is in; '' for none.
        text: the line as it stands there, without the blanks round it.
    """

    file: File
    line: Count
    function: str = ""
    text: str = ""


@dataclass(frozen=True)
class Burst:
    """Messages or requests that were sent one after another from one line.

    Attributes:
        line: which of the end's lines, from 0.
        times: how many.
    """

    line: Count
    times: Count


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
    used: Count
    place: SourceLine | None = None
    used_at: SourceLine | None = None
    lines: tuple[SourceLine, ...] = ()
    sent: Annotated[tuple[Burst, ...], STRANGERS._replace(entries=MOST_SENT)] = ()


@dataclass(frozen=True)
class Wait:
    """A wait for a service, an action server or a message that lasted.

    Attributes:
        name, type: of what was waited for.
        since_s, lasted_s: None: until the end.
    """

    name: str
    type: str
    since_s: Seconds
    lasted_s: Seconds | None
    place: SourceLine | None = None


@dataclass(frozen=True)
class SlowCallback:
    """A callback that let time pass: the node could do nothing else meanwhile.

    Attributes:
        place: the line in it that took longest.
        longest_s, times: how long at most, and how often it let more than a tick pass.
    """

    place: SourceLine
    longest_s: Seconds
    times: Count


@dataclass(frozen=True)
class TimerLine:
    """A line that makes a timer.

    Attributes:
        period_s: of the last that it has made.
        times: how many it has made; of a process that was ended by force, so many at least.
    """

    place: SourceLine
    period_s: Seconds
    times: Count


@dataclass(frozen=True)
class Caught:
    """An exception that has left a callback, and did not end the program.

    Attributes:
        type, text: as in `Raised`.
        time_s: when it was seen first.
        times: how often it was seen.
        place: the last line of the submission's own that it came from.
    """

    type: str
    text: str
    time_s: Seconds
    times: Count
    place: SourceLine


@dataclass(frozen=True)
class LintFinding:
    """A finding in the source: no error by itself, and seldom what was meant.

    Attributes:
        kind: what was found; the kinds are those of the diagnoser that looks
            (`docs/lint-findings.md`), and "raises": the exception NAME came to this line.
        name, near: what the kind says of.
    """

    kind: str
    name: str
    near: str
    place: SourceLine


@dataclass(frozen=True)
class LineText:
    """A text about a line."""

    line: Count
    text: str


@dataclass(frozen=True)
class RanFile:
    """What has run of a file.

    Attributes:
        lines: that have run at least once.
        asked: of lines with a condition, what its names stood for: 'self.state = 0'.
        raised: of lines that an exception came to, its type and text.
    """

    file: File
    lines: Annotated[tuple[Count, ...], STRANGERS._replace(entries=20_000)]
    asked: tuple[LineText, ...]
    raised: tuple[LineText, ...]


@dataclass(frozen=True)
class Standstill:
    """Where the program was when it went no further, or the run ended.

    Attributes:
        kind: `callback` - it waits in a callback for what only another could bring; `call` - it
            waits in a call while nobody spins; `loop` - it computes without end. At the end of a
            run, of its main thread: `init` - it was still in an `__init__`; `going` - it was in a
            loop of its own, and did not just spin.
        call: the last function of a library that it was in, as 'Client.call'; '' for none.
    """

    kind: StopKind
    time_s: Seconds
    call: str = ""
    place: SourceLine | None = None


@dataclass(frozen=True)
class Raised:
    """The exception that ended the program or its thread that spun; or a signal for a mistake in C.

    Attributes:
        type: as 'ZeroDivisionError'; 'SIGABRT' for a signal.
        place: the last line of the submission's own; None where there is none.
    """

    type: str
    text: str
    time_s: Seconds
    place: SourceLine | None = None


@dataclass(frozen=True)
class Observations:
    """All observations of one process.

    Attributes:
        is_known: whether anything was reported at all; False for controllers in other languages.
        ends: in the order in which they were made.
        spun_s: when an executor was first spun; None for never.
        waits: services and the like that were waited for longer than a second, or in vain.
        slow: callbacks that let time pass.
        timers: the lines that have made timers, in the order in which they came.
        caught: exceptions that have left callbacks, after which the program went on.
        lint_findings: in the files that it has loaded.
        stop: where it got stuck.
        raised: what ended it; of a thread that spun, the program may have gone on without it.
        returned_s: when its program came to its end by itself, without an error.
    """

    is_known: bool = False
    ends: tuple[End, ...] = ()
    spun_s: Seconds | None = None
    waits: tuple[Wait, ...] = ()
    slow: tuple[SlowCallback, ...] = ()
    timers: tuple[TimerLine, ...] = ()
    caught: tuple[Caught, ...] = ()
    lint_findings: tuple[LintFinding, ...] = ()
    stop: Standstill | None = None
    raised: Raised | None = None
    returned_s: Seconds | None = None

    def joined(self, others: Sequence[Observations]) -> Observations:
        """Return them with what other programs beside this one have made and done."""
        made: dict[str, Any] = {}
        for name in ("ends", "waits", "slow", "timers", "caught", "lint_findings"):
            made[name] = tuple(e for each in (self, *others) for e in getattr(each, name))
        return replace(self, **made)

    def to_json(self) -> dict[str, Any]:
        return asdict(self)

    @classmethod
    def from_json(cls, data: Any) -> Self:
        """Parse observations, which are not trusted."""
        observations = from_json(cls, data, STRANGERS)
        for end in observations.ends:
            if any(each.line >= len(end.lines) for each in end.sent):
                raise ValueError(f"expected one of {len(end.lines)} lines in {end.sent!r:.80}")
        return observations


# Exceptions in what a program has printed, which may be made to be hard to read ------------------

# blanks of one line only: lines of nothing would be gone through again from each of them
_FRAME = re.compile(
    r'^[^\S\n]*File "(?P<file>[^"\n]{1,1000})", line (?P<line>\d{1,9})'
    r"(?:, in (?P<function>[^\n]{1,200}))?"
    r'(?:\n[^\S\n]{3,40}(?!\s|File ")(?P<text>[^\n]{0,1000}))?',
    re.MULTILINE,
)
_ERROR = re.compile(r"^(?P<name>[A-Za-z_][\w.]{0,200})(?:: (?P<text>.*))?$")
#: Parts of the paths of Python's, ROS's and the grader's files; no submission's.
_LIBRARIES = ("/site-packages/", "/dist-packages/", "/lib/python3", "/grader/run/", "<frozen ")


def is_library(file: str) -> bool:
    """Whether a file is Python's, ROS's or the grader's, and not the submission's."""
    return any(part in file for part in _LIBRARIES)


def last_exception(text: str) -> Raised | None:
    """Parse the last traceback: its exception, at the last line of the submission's files."""
    start = text.rfind("Traceback (most recent call last)")
    # a SyntaxError in the file that was started has no traceback of its own
    part = text[max(start, 0) :]
    frames = list(_FRAME.finditer(part))
    if not frames:
        return None
    lines = part[frames[-1].end() :].splitlines()
    error = next((match for line in lines if (match := _ERROR.match(line))), None)
    if error is None:
        return None
    return Raised(error["name"], error["text"] or "", 0.0, _submission_line(frames))


def _submission_line(frames: list[re.Match[str]]) -> SourceLine | None:
    """Return the last of the frames that is no library's."""
    frame = next((f for f in reversed(frames) if not is_library(f["file"])), None)
    if frame is None:
        return None
    function, text = (frame["function"] or "").strip(), (frame["text"] or "").strip()
    function = "" if function.startswith("<") else function
    return SourceLine(PurePath(frame["file"]).name, int(frame["line"]), function, text)
