"""Points for systems that know whole numbers only, so that the parts still add up to the total."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import ROUND_HALF_UP, Decimal

from grader.exercise.verdict import Verdict


@dataclass(frozen=True)
class WholePoints:
    """Whole points, one of each list per verdict.

    Attributes:
        scores, max_scores: what was earned, and what can be.
        factor: what everything was multiplied with: 1 wherever the checks are worth whole points.
    """

    scores: tuple[int, ...]
    max_scores: tuple[int, ...]
    factor: int

    @property
    def total(self) -> int:
        """The sum of the scores: the exact total, times the factor, rounded half up."""
        return sum(self.scores)

    @property
    def max_total(self) -> int:
        """The sum of what can be earned."""
        return sum(self.max_scores)


def whole_points(verdicts: Sequence[Verdict]) -> WholePoints:
    """Round by largest remainders.

    The total is rounded half up. Every score is rounded down, and the points that are then missing
    from the total go to the scores that lost most. Where a check is worth 2.5 points, all points
    count ten times (or a hundred times), so that passing is worth the same to the last digit.
    """
    most = [_decimal(v.max_score) for v in verdicts]
    factor = next((f for f in (1, 10) if all(m * f % 1 == 0 for m in most)), 100)
    max_scores = [int(_half_up(m * factor)) for m in most]
    exact = [
        min(_decimal(v.score) * factor, Decimal(m))
        for v, m in zip(verdicts, max_scores, strict=True)
    ]
    scores = [int(score) for score in exact]
    missing = int(_half_up(sum(exact, Decimal(0)))) - sum(scores)
    by_loss = sorted(range(len(exact)), key=lambda i: scores[i] - exact[i])
    for index in by_loss[:missing]:
        scores[index] += 1
    return WholePoints(tuple(scores), tuple(max_scores), factor)


def zero_points(max_score: float) -> WholePoints:
    """Nothing of `max_score`, where the parts are not known."""
    return WholePoints((0,), (int(_half_up(_decimal(max_score))),), 1)


def _decimal(value: float) -> Decimal:
    return Decimal(str(round(value, 2)))


def _half_up(value: Decimal) -> Decimal:
    return value.to_integral_value(ROUND_HALF_UP)
