"""What a page that plays runs is made from: the runs, and what was found in them, as plain data."""

from __future__ import annotations

from dataclasses import dataclass

from grader.recording.subject import Start, Trace


@dataclass(frozen=True)
class Moment:
    """A piece of evidence.

    Attributes:
        number: 1, 2, ... over all checks.
        run: 0 for the nominal run, 1, 2, ... for the varied ones.
        time_s: when [simulated s].
        place: x, y [m]; None for nowhere.
        text: when, where and what, in words.
    """

    number: int
    run: int
    time_s: float
    place: tuple[float, float] | None
    text: str


@dataclass(frozen=True)
class JudgedCheck:
    """What a check says.

    Attributes:
        title: what it asks for.
        status: `passed`, `failed` or `not_judged`.
        word: the same for people, with its points.
        rationale, help: what was seen, what to look at.
        moments: where to see it.
    """

    title: str
    status: str
    word: str
    rationale: str
    help: str
    moments: tuple[Moment, ...]


@dataclass(frozen=True)
class Line:
    """A line of a submission.

    Attributes:
        file, line, text: where it stands, and what.
    """

    file: str
    line: int
    text: str


@dataclass(frozen=True)
class Sent:
    """From where what was sent by one name, as the submission's process has told.

    Attributes:
        name: of a topic or service, with its namespace.
        times: how often it was sent.
        lines: from where it was sent.
        order: (which of the lines, how often in a row), from the first that was sent on; not
            always to the last.
    """

    name: str
    times: int
    lines: tuple[Line, ...]
    order: tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class Take:
    """A run.

    Attributes:
        number: 0 for the nominal one.
        title: 'Nominal run', 'Varied run 1'.
        outcome: how it ended, in a word or two.
        sent: from where things were sent, one for a name at most.
        start: where it began; None for the usual place.
    """

    number: int
    title: str
    outcome: str
    trace: Trace
    start: Start | None = None
    sent: tuple[Sent, ...] = ()


@dataclass(frozen=True)
class Playback:
    """All that is played.

    Attributes:
        title: whose it is, in a line.
        summary: what came of it, in a line; '' where nobody has judged it.
        takes: the nominal run, and the varied ones.
        judged: what the checks say, in their order.
        other: what it is to be compared with.
    """

    title: str
    summary: str
    takes: tuple[Take, ...]
    judged: tuple[JudgedCheck, ...] = ()
    other: Playback | None = None
