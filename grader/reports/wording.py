"""How verdicts and their points are put into words, the same in all formats."""

from __future__ import annotations

from typing import Final

from grader import text
from grader.exercise.verdict import Evidence, Verdict
from grader.result.result import NotShown, Result

WORDS: Final = {"passed": "passed", "failed": "failed", "not_judged": "not judged"}
#: What a teacher is told of a verdict that students do not see, or not all of.
SEEN_BY_STUDENTS: Final = {
    "after_due": "students see it when the exercise is over",
    "points_only": "students see its points alone",
    "never": "students never see it",
}
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


def nothing_to_mend(passed: int, left_out: NotShown | None) -> str:
    """The headline where all verdicts that are shown passed."""
    if left_out is None:
        return f"Nothing to mend: {all_passed(passed)}"
    others = f"{text.count(left_out.checks, 'check')} {_be(left_out.checks)} not shown"
    if not passed:
        return f"Nothing is shown here: {others}."
    return f"Nothing to mend in what is shown: {text.count(passed, 'check')} passed; {others}."


def not_shown(left_out: NotShown | None) -> str:
    """That there are more checks than those that are shown; '' where there are none."""
    if left_out is None:
        return ""
    checks, later = left_out.checks, left_out.until_due
    said = (
        f"{text.count(checks, 'check')} worth {text.points(left_out.max_score)} points "
        f"{_be(checks)} not shown here, nor counted in this score"
    )
    if not later:
        return f"{said}."
    which = "" if later == checks else f"{later} of them "
    shown = f"{_be(later)} shown" if which else "shown"
    return f"{said}; {which}{shown} when the exercise is over."


def handed_in(result: Result) -> list[str]:
    """Whose a result is, and what it costs that it came late; nothing where nobody has said it."""
    found = result.handed_in
    if found is None:
        return []
    when = f", handed in {found.at.replace('T', ' ')}" if found.at else ""
    said = [f"{found.name or found.id}, attempt {found.attempt}{when}."]
    if found.late_s <= 0:
        return said
    late = f"Handed in {duration(found.late_s)} late"
    if not found.deducted:
        return [*said, f"{late}, which costs no points."]
    less = f"{late}: {text.points(found.deducted)} points less"
    if result.not_shown is not None:  # of a total from which what is hidden could be told
        return [*said, f"{less} in the total of all checks."]
    return [
        *said,
        f"{less}; {text.points(result.final)} instead of {text.points(result.score)}.",
    ]


def duration(seconds: float) -> str:
    """A time that people count in days, hours and minutes: '1 day 3 h', '2 h 10 min', '40 s'."""
    if seconds < 60:
        return f"{max(seconds, 1):.0f} s"
    minutes = int(seconds // 60)
    days, hours, minutes = minutes // 1440, minutes // 60 % 24, minutes % 60
    parts = [text.count(days, "day") if days else "", f"{hours} h" if hours else ""]
    parts.append(f"{minutes} min" if minutes and not days else "")
    return " ".join(part for part in parts if part)


def _be(number: int) -> str:
    return "is" if number == 1 else "are"
