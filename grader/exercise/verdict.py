"""What a check says: passed, failed, or not judged, and why."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from numbers import Real
from typing import Literal

from grader.strict_json import SPARSE

Status = Literal["passed", "failed", "not_judged"]
#: What students see of a check: all of it; all of it, when the exercise is over, and until then
#: nothing; title, verdict and points; nothing.
Visible = Literal["now", "after_due", "points_only", "never"]


@dataclass(frozen=True)
class Evidence:
    """A moment of the recording that a verdict points to.

    Attributes:
        tick: the simulator's tick, 1 for the first of the recording.
        time_s: the same moment in simulated seconds.
        x, y: where it happened [m].
        note: what happened there.
        run: 0 for the nominal run, 1, 2, ... for the varied ones.
    """

    tick: int
    time_s: float
    x: float
    y: float
    note: str
    run: int = 0

    @property
    def has_place(self) -> bool:
        """Whether it was anywhere: a position can be not a number."""
        return math.isfinite(self.x) and math.isfinite(self.y)


@dataclass(frozen=True)
class Expected:
    """What a check wants of something over time, for who looks at its plot.

    Attributes:
        curve: the title of the curve in the scene's view.
        text: what is wanted, in words.
        within: between which values it has to stay; None where that is not said by values.
        beyond: a value that it has to fall below, and one that it has to rise above.
    """

    curve: str
    text: str
    within: tuple[float, float] | None = field(default=None, metadata=SPARSE)
    beyond: tuple[float, float] | None = field(default=None, metadata=SPARSE)


@dataclass(frozen=True)
class Finding:
    """What a check function returns.

    Attributes:
        share: how much of the points is earned, 0 to 1; 1 is a pass.
        rationale: what was seen, with numbers.
        help: what to look at, without giving the code away; for anything but a pass.
        evidence: where to see it.
        judged: False where the check cannot tell, for no fault of the submission's: the verdict is
            then "not judged", and says why by `rationale`.
        expected: what is wanted of curves, for their plots; it decides nothing.
    """

    share: float
    rationale: str
    help: str = ""
    evidence: tuple[Evidence, ...] = ()
    judged: bool = True
    expected: tuple[Expected, ...] = ()


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
    title: str
    status: Status
    score: float
    max_score: float
    rationale: str
    help: str = ""
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

    @property
    def share(self) -> float:
        """How much of the points is earned, 0 to 1."""
        if self.max_score <= 0:
            return 1.0 if self.passed else 0.0
        return min(self.score / self.max_score, 1.0)


def wrong_with(finding: object, runs: int) -> str:
    """Why something that a check returned is no finding about so many runs; '' if it is one."""
    if not isinstance(finding, Finding):
        return f"returns a {type(finding).__name__}; expected a Finding"
    share: object = finding.share
    if not _is_number(share) or not -1e-9 <= float(share) <= 1 + 1e-9:  # type: ignore[arg-type]
        return f"share: expected a number from 0 to 1, found {share!r}"
    for name in ("rationale", "help"):
        text = getattr(finding, name)
        if not isinstance(text, str):
            return f"{name}: expected a text, found {text!r}"
    if type(finding.judged) is not bool:
        return f"judged: expected True or False, found {finding.judged!r}"
    evidence: object = finding.evidence
    if not isinstance(evidence, tuple):
        return f"evidence: expected a tuple, found a {type(evidence).__name__}"
    wrong = next(filter(None, (_wrong_with_evidence(item, runs) for item in evidence)), "")
    expected: object = finding.expected
    if not wrong and not isinstance(expected, tuple):
        return f"expected: expected a tuple, found a {type(expected).__name__}"
    return wrong or next(filter(None, map(_wrong_with_expected, finding.expected)), "")


def _wrong_with_expected(item: object) -> str:
    if not isinstance(item, Expected):
        return f"expected: expected Expected, found a {type(item).__name__}"
    for name in ("curve", "text"):
        if not isinstance(getattr(item, name), str):
            return f"expected: {name}: expected a text, found {getattr(item, name)!r}"
    for name in ("within", "beyond"):
        pair = getattr(item, name)
        if pair is None:
            continue
        is_pair = isinstance(pair, tuple) and len(pair) == 2
        if not is_pair or not all(_is_number(value) and math.isfinite(value) for value in pair):
            return f"expected: {name}: expected two finite numbers, found {pair!r}"
    return ""


def _wrong_with_evidence(item: object, runs: int) -> str:
    if not isinstance(item, Evidence):
        return f"evidence: expected Evidence, found a {type(item).__name__}"
    for name in ("tick", "run"):
        value = getattr(item, name)
        if type(value) is not int or value < 0:
            return f"evidence: {name}: expected a whole number from 0, found {value!r}"
    for name in ("time_s", "x", "y"):  # JSON has no other numbers than finite ones
        value = getattr(item, name)
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        if not is_number or not math.isfinite(value) or (name == "time_s" and value < 0):
            return f"evidence: {name}: expected a finite number, found {value!r}"
    if not isinstance(item.note, str):
        return f"evidence: note: expected a text, found {item.note!r}"
    if item.run >= runs:
        return f"evidence: there is no run {item.run}; there are {runs}, from 0 on"
    return ""


def _is_number(value: object) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool)
