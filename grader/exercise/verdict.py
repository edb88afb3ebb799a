"""What a check says: passed, failed, or not judged, and why."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

Status = Literal["passed", "failed", "not_judged"]


@dataclass(frozen=True)
class Evidence:
    """A moment of the recording that a verdict points to.

    Attributes:
        tick: the simulator's tick, 1 for the first of the recording.
        time_s: the same moment in simulated seconds.
        x, y: where the turtle was [m].
        note: what happened there.
        run: 0 for the nominal run, 1, 2, ... for the varied ones.
    """

    tick: int
    time_s: float
    x: float
    y: float
    note: str
    run: int = 0


@dataclass(frozen=True)
class Finding:
    """What a check function returns.

    Attributes:
        share: how much of the points is earned, 0 to 1; 1 is a pass.
        rationale: what was seen, with numbers.
        help: what to look at, without giving the code away; for anything but a pass.
        evidence: where to see it.
    """

    share: float
    rationale: str
    help: str = ""
    evidence: tuple[Evidence, ...] = ()


@dataclass(frozen=True)
class Verdict:
    """The judgement of one check, as it stands in the result file."""

    check: str
    title: str
    status: Status
    score: float
    max_score: float
    rationale: str
    help: str = ""
    evidence: tuple[Evidence, ...] = ()
    depends_on: tuple[str, ...] = field(default=())

    def as_json(self) -> dict[str, Any]:
        """The verdict as the result file holds it."""
        return {
            "check": self.check,
            "title": self.title,
            "status": self.status,
            "score": self.score,
            "max_score": self.max_score,
            "rationale": self.rationale,
            "help": self.help,
            "evidence": [vars(item) for item in self.evidence],
            "depends_on": list(self.depends_on),
        }
