"""How verdicts and their points are put into words, the same in all formats."""

from __future__ import annotations

from typing import Final

from grader import text
from grader.exercise.verdict import Evidence, Verdict

WORDS: Final = {"passed": "passed", "failed": "failed", "not_judged": "not judged"}
#: What stands in place of a check's advice where the first line knows the cause.
SEE_FIRST: Final = "See the first line."
#: What a run says of itself that ended because nothing had moved.
NOTHING_MOVED: Final = "nothing moved"


def word(verdict: Verdict) -> str:
    """The verdict in words."""
    return WORDS[verdict.status]


def title_of(verdict: Verdict) -> str:
    """What its check asks for; its name where that has no title."""
    return verdict.title or verdict.check


def score_text(verdict: Verdict) -> str:
    """The points: '12.5 / 30'."""
    return f"{text.points(verdict.score)} / {text.points(verdict.max_score)}"


def all_passed(checks: int) -> str:
    """That nothing is to be mended: 'all 7 checks passed.'."""
    return "the only check passed." if checks == 1 else f"all {checks} checks passed."


def where(evidence: Evidence) -> str:
    """Time and place: 'at 12.34 s, at (5.54, 7.20)'."""
    run = f"varied run {evidence.run}, " if evidence.run else ""
    return f"{run}at {evidence.time_s:.2f} s, at {text.place(evidence.x, evidence.y)}"
