"""The checks of a class as one table: how many passed, the mean, what the others have to fix."""

from __future__ import annotations

from collections import Counter
from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass
from statistics import fmean

from grader import Result, Verdict
from grader.text import Message, plain_text, shown, translate

_LONGEST_LINE = 400
#: Whether it is about the run as a whole, and not about the check.
_Line = tuple[bool, Message]


@dataclass(frozen=True)
class CheckRow:
    """A check, over all whose submission ran.

    Attributes:
        count, passed: how many it concerned, and how many of them passed.
        mean: what they earned on average [points].
        first_line: what most of those who failed have to fix first, as one of them reads it; ''
            where nobody failed.
        alike: how many of them read the same, but for its values.
    """

    check: str
    title: Message
    max_score: float
    count: int
    passed: int
    mean: float
    first_line: str
    alike: int


def check_rows(results: Sequence[Result], points: Mapping[str, float]) -> list[CheckRow]:
    """Return a row for each check: in the exercise's order, then any others.

    Args:
        points: check -> points, of the exercise.
    """
    verdicts: dict[str, list[Verdict]] = {check: [] for check in points}
    lines: dict[str, list[_Line]] = {check: [] for check in points}
    for result in results:
        for verdict in result.verdicts:
            verdicts.setdefault(verdict.check, []).append(verdict)
            if verdict.status == "failed":
                lines.setdefault(verdict.check, []).append(_first_line(result, verdict))
    return [_row(found, lines.get(check, [])) for check, found in verdicts.items() if found]


def _row(verdicts: Sequence[Verdict], lines: Sequence[_Line]) -> CheckRow:
    first_line, alike = _most_frequent(lines)
    return CheckRow(
        check=verdicts[0].check,
        title=verdicts[0].title or plain_text(verdicts[0].check),
        max_score=verdicts[0].max_score,
        count=len(verdicts),
        passed=sum(verdict.passed for verdict in verdicts),
        mean=fmean(verdict.score for verdict in verdicts),
        first_line=first_line,
        alike=alike,
    )


def _first_line(result: Result, verdict: Verdict) -> _Line:
    """Return the first line of a report, unless that is about another check."""
    diagnosis = result.diagnosis
    if diagnosis is not None and diagnosis.check in ("", verdict.check):
        return not diagnosis.check, diagnosis.cause
    return False, verdict.rationale


def _most_frequent(lines: Sequence[_Line]) -> tuple[str, int]:
    """Return the most frequent line and how many are alike.

    Of equals it is one of the check itself, and of those the first by alphabet.
    """
    by_kind: dict[tuple[bool, Hashable], Counter[str]] = {}
    for is_of_run, line in lines:
        sentence = shown(translate(line), _LONGEST_LINE)
        by_kind.setdefault((is_of_run, _kind(line)), Counter())[sentence] += 1
    if not by_kind:
        return "", 0
    most = max(each.total() for each in by_kind.values())
    _, example = min(
        (is_of_run, min(each, key=lambda sentence: (-each[sentence], sentence)))
        for (is_of_run, _), each in by_kind.items()
        if each.total() == most
    )
    return example, most


def _kind(line: Message) -> Hashable:
    """Return what is the same in lines that differ in their values alone: times, places, names."""
    if line.text is not None:
        return line.text
    if line.is_row:
        return tuple(_kind(p) if isinstance(p, Message) else p for p in line.values.values())
    return line.key
