"""The result of a check: passed, failed, or not judged, and why."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from grader.recording.evidence import Evidence as Evidence
from grader.recording.evidence import convert_texts
from grader.system.strict_json import OURS, SPARSE, from_json, to_json
from grader.text.message import NOTHING, Message

Status = Literal["passed", "failed", "not_judged"]
#: What students see of a check: all of it; all of it, when the exercise is over, and until then
#: nothing; title, verdict and points; nothing.
Visible = Literal["now", "after_due", "points_only", "never"]


def _a_share(number: float) -> float:
    if not -1e-9 <= number <= 1 + 1e-9:
        raise ValueError(f"expected a number from 0 to 1, found {number!r}")
    return number


@dataclass(frozen=True)
class Expected:
    """The values that a check expects over time, for their plot.

    Attributes:
        curve: the title of the curve in the scene's view.
        text: the expectation in words.
        within: between which values the curve has to stay; None where there are none.
        beyond: a value that the curve has to fall below, and one that it has to rise above.
    """

    curve: Message
    text: Message
    within: tuple[float, float] | None = field(default=None, metadata=SPARSE)
    beyond: tuple[float, float] | None = field(default=None, metadata=SPARSE)

    def __post_init__(self) -> None:
        """Convert plain texts to messages."""
        convert_texts(self, "curve", "text")


@dataclass(frozen=True)
class Finding:
    """The return value of a check function.

    Attributes:
        share: how much of the points is earned, 0 to 1; 1 is a pass.
        rationale: what was seen, with numbers.
        help: a hint that does not give the code away; for anything but a pass.
        evidence: where to see it.
        judged: False where the check cannot decide, for no fault of the submission's: the verdict
            is then "not judged", and `rationale` says why.
        expected: what curves should be like, for their plots; it decides nothing.
    """

    share: Annotated[float, _a_share]
    rationale: Message
    help: Message = NOTHING
    evidence: tuple[Evidence, ...] = ()
    judged: bool = True
    expected: tuple[Expected, ...] = ()

    def __post_init__(self) -> None:
        """Convert plain texts to messages."""
        convert_texts(self, "rationale", "help")


@dataclass(frozen=True)
class Verdict:
    """The judgement of one check.

    Attributes:
        check: its name.
        title: what it asks for.
        score, max_score: the points that it earned, and that it can earn.
        rationale, help, evidence, expected: see `Finding`.
        depends_on: the checks that have to pass before it is judged.
        visible: what students see of it.
    """

    check: str
    title: Message
    status: Status
    score: float
    max_score: float
    rationale: Message
    help: Message = NOTHING
    evidence: tuple[Evidence, ...] = ()
    depends_on: tuple[str, ...] = ()
    visible: Visible = field(default="now", metadata=SPARSE)
    expected: tuple[Expected, ...] = field(default=(), metadata=SPARSE)

    @property
    def passed(self) -> bool:
        """Whether it passed; not judged is not passed."""
        return self.status == "passed"

    @property
    def is_partial(self) -> bool:
        """Whether it failed, and earned points all the same."""
        return self.status == "failed" and self.score > 0

    def waited_for(self, verdicts: Mapping[str, Verdict]) -> tuple[str, ...]:
        """Return which of these had to pass before it is judged, and did not."""
        if self.status != "not_judged":
            return ()
        return tuple(n for n in self.depends_on if n in verdicts and not verdicts[n].passed)


def as_json(finding: object, runs: int) -> Any:
    """Return what a check returned as JSON, which `from_json` makes a `Finding` of.

    Raises:
        TypeError, ValueError: it is no finding about so many runs.
    """
    if not isinstance(finding, Finding):
        raise TypeError(f"returns a {type(finding).__name__}; expected a Finding")
    # numbers of numpy become Python's; no others are JSON's than finite ones
    data = json.loads(json.dumps(to_json(finding, OURS), default=float, allow_nan=False))
    for item in from_json(Finding, data, OURS).evidence:
        if (item.x is None) != (item.y is None):
            raise ValueError(
                f"evidence: expected x and y, or none, found {item.x!r} and {item.y!r}"
            )
        if item.run >= runs:
            raise ValueError(f"evidence: there is no run {item.run}; there are {runs}, from 0 on")
    return data
