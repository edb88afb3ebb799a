"""A result's parts as a report shows them: translated, in one language, and of limited length."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

from grader.exercise.result.diagnosis import Diagnosis
from grader.exercise.result.result import Result, RunSummary
from grader.exercise.verdict import Verdict
from grader.text import strings as text
from grader.text.message import Message, Text, msg
from grader.text.translations import tr, translate

#: A text of a verdict is not shown beyond this; an exception's message has no length by nature.
_TEXT_LIMIT = 2000
RAW_LIMIT = 10 * _TEXT_LIMIT  # of a text before it is made plain, which can shorten it
_POINTS_LIMIT = 20
_FLAGS_LIMIT = 50


def line(value: Text) -> str:
    """Return a text as one line of limited length."""
    return text.shown(translate(value), _TEXT_LIMIT)


def few(result: Result) -> Result:
    """Return a result with a limited number of pieces of evidence and flags."""
    return replace(
        result,
        verdicts=tuple(
            replace(verdict, evidence=verdict.evidence[:_POINTS_LIMIT])
            for verdict in result.verdicts
        ),
        run=_few_flags(result.run),
        varied_runs=tuple(map(_few_flags, result.varied_runs)),
    )


def _few_flags(run: RunSummary) -> RunSummary:
    flags = list(run.flags[:_FLAGS_LIMIT])
    if more := len(run.flags) - len(flags):
        flags.append(msg("and {more} more", more=more))
    return replace(run, flags=tuple(flags))


def flags(run: RunSummary) -> tuple[str, ...]:
    """Return the remarks on a run, clipped."""
    return tuple(_clipped(flag) for flag in run.flags)


def of_verdict(verdict: Verdict, name: str) -> Verdict:
    """Return a verdict by another name, its texts and evidence translated and clipped."""
    return replace(
        verdict,
        check=name,
        title=Message.of(line(verdict.title)),
        score=float(verdict.score),
        max_score=float(verdict.max_score),
        rationale=Message.of(_clipped(verdict.rationale)),
        help=Message.of(_clipped(verdict.help)),
        evidence=tuple(
            replace(each, note=Message.of(line(each.note))) for each in verdict.evidence
        ),
    )


def of_diagnosis(found: Diagnosis) -> Diagnosis:
    """Return a diagnosis whose texts are single lines of limited length."""
    key, place = line(found.key), found.place
    if place is not None:
        file, function, code = map(line, (place.file, place.function, place.text))
        place = replace(place, file=file, function=function, text=code)
    return replace(
        found,
        key=key,
        cause=Message.of(line(found.cause) or key or tr("(no cause)")),
        help=Message.of(line(found.help)),
        place=place,
        check=line(found.check),
    )


def distinct(names: list[str]) -> list[str]:
    """Return the names, none empty and no two alike: some systems drop duplicates."""
    seen: Counter[str] = Counter()
    distinct: list[str] = []
    for index, name in enumerate(names, 1):
        base = name or f"check {index}"
        seen[base] += 1
        candidate = base if seen[base] == 1 else f"{base} ({seen[base]})"
        while candidate in distinct:
            candidate += "'"
        distinct.append(candidate)
    return distinct


def _clipped(value: Text) -> str:
    return text.clip(text.plain(translate(value)), _TEXT_LIMIT)
