"""Statistics of a class: the distribution of scores, and each check as a test item.

Classical test theory. Of a check, over all whose submission ran:

- difficulty index p: the mean share of its points, 0 to 1; what was not judged counts 0. Where a
  check gives all or nothing, that is the share of those who passed (Crocker & Algina 1986, ch. 14).
- discrimination: Pearson's correlation between the check's points and those of all *other* checks,
  the corrected item-total correlation (Henrysson 1963, Psychometrika 28, 211-218). Where a check
  gives all or nothing it is the point-biserial one. The words are those of Ebel & Frisbie (1991).
"""

from __future__ import annotations

import statistics
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from grader.exercise.verdict import Verdict
from grader.message import NOTHING, Message, msg, plain_text
from grader.result.result import Result
from grader.translations import tr

BINS = 10
#: With fewer results a correlation means nothing.
LEAST = 10
_WORDS = (
    (0.4, msg("separates strong from weak very well")),
    (0.3, msg("separates strong from weak well")),
    (0.2, msg("separates strong from weak a little")),
    (0.0, msg("hardly separates strong from weak")),
    (-1.0, msg("the weak do better here than the strong: look at what it asks for")),
)
_EASY, _HARD = 0.85, 0.3


@dataclass(frozen=True)
class Bar:
    """The number of scores from `low` to below `high`; the last bar includes `high` [points]."""

    low: float
    high: float
    count: int


@dataclass(frozen=True)
class Distribution:
    """The distribution of scores [points].

    Attributes:
        spread: the standard deviation of a sample (n - 1); 0 of a single score.
        quartiles: the first and the third.
        full: how many have all points.
    """

    count: int
    mean: float
    median: float
    spread: float
    quartiles: tuple[float, float]
    lowest: float
    highest: float
    full: int
    bars: tuple[Bar, ...]

    @property
    def most(self) -> int:
        """The count of the highest bar."""
        return max(bar.count for bar in self.bars)


@dataclass(frozen=True)
class CheckFigures:
    """The statistics of a check.

    Attributes:
        check, title, max_score: those of the check.
        count: how many it has judged, or tried to.
        passed, partial, failed, not_judged: of them; `partial` failed and earned points.
        difficulty: the mean share of its points, 0 to 1.
        discrimination: -1 to 1; None where it is not defined, and then `why_not` says why.
    """

    check: str
    title: Message
    max_score: float
    count: int
    passed: int
    partial: int
    failed: int
    not_judged: int
    difficulty: float
    discrimination: float | None
    why_not: Message = NOTHING

    @property
    def parts(self) -> tuple[tuple[str, str, int], ...]:
        """The four counts, each with its CSS class and a word."""
        return (
            ("passed", tr("passed"), self.passed),
            ("partial", tr("partly"), self.partial),
            ("failed", tr("failed"), self.failed),
            ("not_judged", tr("not judged"), self.not_judged),
        )

    @property
    def words(self) -> str:
        """The figures in words."""
        ease = tr("Easy") if self.difficulty >= _EASY else tr("Medium")
        ease = tr("Hard") if self.difficulty < _HARD else ease
        separates = self.why_not
        if self.discrimination is not None:
            rounded = round(self.discrimination, 2)
            separates = next(words for least, words in _WORDS if rounded >= least)
        return tr("{ease}; {separates}.", ease=ease, separates=separates)


def distribution(scores: Sequence[float], max_score: float) -> Distribution | None:
    """Return the distribution of scores; None where there are none."""
    if not scores:
        return None
    single = len(scores) == 1
    quartiles = [scores[0]] * 3 if single else statistics.quantiles(scores, method="inclusive")
    return Distribution(
        len(scores),
        statistics.fmean(scores),
        statistics.median(scores),
        0.0 if single else statistics.stdev(scores),
        (quartiles[0], quartiles[2]),
        min(scores),
        max(scores),
        sum(score >= max_score - 1e-9 for score in scores),
        _bars(scores, max_score),
    )


def _bars(scores: Sequence[float], max_score: float) -> tuple[Bar, ...]:
    width = max(max_score, *scores, 1e-9) / BINS
    places = [min(int(score / width + 1e-9), BINS - 1) for score in scores]
    return tuple(Bar(k * width, (k + 1) * width, places.count(k)) for k in range(BINS))


def items(results: Sequence[Result], points: Mapping[str, float]) -> list[CheckFigures]:
    """Return the statistics of each check: in the exercise's order, then any others."""
    of_each = [{verdict.check: verdict for verdict in result.verdicts} for result in results]
    names = dict.fromkeys([*points, *(name for verdicts in of_each for name in verdicts)])
    return [
        _item([(verdicts[name], verdicts) for verdicts in of_each if name in verdicts])
        for name in names
        if any(name in verdicts for verdicts in of_each)
    ]


def _item(asked: Sequence[tuple[Verdict, Mapping[str, Verdict]]]) -> CheckFigures:
    verdicts = [verdict for verdict, _ in asked]
    # rounded: equal sums of other parts are equal, and a constant is one
    rest = [
        round(sum(v.score for v in others.values()) - verdict.score, 6) for verdict, others in asked
    ]
    found, why_not = _discrimination([verdict.score for verdict in verdicts], rest)
    return CheckFigures(
        verdicts[0].check,
        verdicts[0].title or plain_text(verdicts[0].check),
        verdicts[0].max_score,
        len(verdicts),
        sum(verdict.passed for verdict in verdicts),
        sum(verdict.is_partial for verdict in verdicts),
        sum(verdict.status == "failed" and not verdict.is_partial for verdict in verdicts),
        sum(verdict.status == "not_judged" for verdict in verdicts),
        statistics.fmean(verdict.share for verdict in verdicts),
        found,
        why_not,
    )


def _discrimination(scores: list[float], rest: list[float]) -> tuple[float | None, Message]:
    """Return the correlation; or None and why there is none."""
    if len(scores) < LEAST:
        return None, msg("fewer than {least} are too few to tell whom it separates", least=LEAST)
    if len(set(scores)) == 1:
        return None, msg("all have the same points here, so it separates nobody")
    if len(set(rest)) == 1:
        return None, msg("all have the same points elsewhere, so there is nothing to compare with")
    return statistics.correlation(scores, rest), NOTHING
