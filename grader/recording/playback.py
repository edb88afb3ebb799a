"""Plain data for a page that plays runs: the runs, and the findings in them."""

from __future__ import annotations

from dataclasses import dataclass

from grader.recording.observations import SourceLine
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
    """The verdict of a check, as shown.

    Attributes:
        title: what it asks for.
        status: `passed`, `failed` or `not_judged`; on a live page, `waiting` before that.
        word: the same for people, with its points.
        rationale, help: what was found, and a hint.
        moments: where to see it.
    """

    title: str
    status: str
    word: str
    rationale: str
    help: str
    moments: tuple[Moment, ...]


@dataclass(frozen=True)
class Sent:
    """The lines that sent on one name, as the submission's process has reported.

    Attributes:
        name: of a topic or service, with its namespace.
        times: how often it was sent.
        lines: that sent; without their functions, so that a line is one.
        order: (which of the lines, how often in a row), from the first that was sent on; not
            always to the last.
    """

    name: str
    times: int
    lines: tuple[SourceLine, ...]
    order: tuple[tuple[int, int], ...]


@dataclass(frozen=True)
class PlayedRun:
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
    """The runs that are played, and their judgement.

    Attributes:
        title: name and score, in a line.
        summary: the diagnosis, in a line; '' where nothing was judged.
        runs: the nominal one, and the varied ones.
        judged: the verdicts, in the order of the checks.
        other: to compare with.
    """

    title: str
    summary: str
    runs: tuple[PlayedRun, ...]
    judged: tuple[JudgedCheck, ...] = ()
    other: Playback | None = None
