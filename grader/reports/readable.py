"""A result's parts as anybody reads them: in a language, no text, list or name of no end."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

from grader import text
from grader.diagnosis.diagnosis import Diagnosis
from grader.exercise.verdict import Verdict
from grader.message import Text, msg, plain_text
from grader.result.result import Result, RunSummary
from grader.translations import tr, translate

#: A text of a verdict is not shown beyond this; an exception's message has no length by nature.
_TEXT_LIMIT = 2000
LOOKED_AT = 10 * _TEXT_LIMIT  # of a text as it comes, with what is not shown of it
_POINTS_LIMIT = 20
_FLAGS_LIMIT = 50


def line(value: Text) -> str:
    """One line, no longer than anybody reads."""
    return text.clip(text.one_line(text.plain(translate(value))), _TEXT_LIMIT)


def few(result: Result) -> Result:
    """A result with no more evidence and flags than anybody reads; the rest need not be read."""
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
    """The remarks on a run."""
    return tuple(_clipped(flag) for flag in run.flags)


def of_verdict(verdict: Verdict, name: str) -> Verdict:
    """A verdict by a name of its own, its texts and evidence in this language and clipped."""
    return replace(
        verdict,
        check=name,
        title=plain_text(text.one_line(text.plain(translate(verdict.title)))),
        score=float(verdict.score),
        max_score=float(verdict.max_score),
        rationale=plain_text(_clipped(verdict.rationale)),
        help=plain_text(_clipped(verdict.help)),
        evidence=tuple(
            replace(each, note=plain_text(line(each.note))) for each in verdict.evidence
        ),
    )


def of_diagnosis(found: Diagnosis) -> Diagnosis:
    """A diagnosis of single lines, none of them longer than anybody reads."""
    key, place = line(found.key), found.place
    if place is not None:
        file, function, said = map(line, (place.file, place.function, place.text))
        place = replace(place, file=file, function=function, text=said)
    return replace(
        found,
        key=key,
        cause=plain_text(line(found.cause) or key or tr("(no cause)")),
        help=plain_text(line(found.help)),
        place=place,
        check=line(found.check),
    )


def distinct(names: list[str]) -> list[str]:
    """The names, none empty and no two alike: some systems drop what is called the same."""
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
