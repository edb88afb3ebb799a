"""How verdicts and their points are put into words, the same in all formats."""

from __future__ import annotations

import re
from typing import Final

from grader import text
from grader.exercise.verdict import Evidence, Verdict
from grader.language.phrase import Phrase, say
from grader.language.telling import number, tell, tell_many, told
from grader.result.result import NotShown, Result

WORDS: Final = {
    "passed": say("passed"),
    "failed": say("failed"),
    "not_judged": say("not judged"),
}
#: What a teacher is told of a verdict that students do not see, or not all of.
SEEN_BY_STUDENTS: Final = {
    "after_due": say("students see it when the exercise is over"),
    "points_only": say("students see its points alone"),
    "never": say("students never see it"),
}
#: What stands in place of a check's advice where the first line knows the cause.
SEE_FIRST: Final = say("See the first line.")
#: What a run says of itself that ended because nothing had moved.
NOTHING_MOVED: Final = "nothing moved"
#: How a run ended, by what `Report.outcome` says.
OUTCOMES: Final = {
    "finished": say("finished"),
    "exited": say("exited"),
    "crashed": say("crashed"),
    "stalled": say("stalled"),
    "time limit": say("time limit"),
    "killed": say("killed"),
    "not run": say("not run"),
    NOTHING_MOVED: say("nothing moved"),
}
#: The clock that a submission lived by.
CLOCKS: Final = {"virtual": say("virtual"), "real": say("real")}
#: How a run was confined and kept apart; a result file puts it together from these.
CONFINED: Final = {
    "namespaces": say("namespaces (of a run)").key,
    "limits": say("limits (of a run)").key,
    "own user": say("own user").key,
    "private network": say("private network").key,
    "ROS domain": say("ROS domain").key,
    "process group": say("process group").key,
    "process tree": say("process tree").key,
    "recording within reach": say("recording within reach").key,
}
_CONFINED: Final = re.compile("|".join(CONFINED))


def word(verdict: Verdict) -> str:
    """The verdict in words."""
    return told(WORDS[verdict.status])


def so_many(status: str, count: int) -> str:
    """How many verdicts are of a kind: '6 passed'."""
    if status == "passed":
        return tell_many("{n} passed", "{n} passed", count)
    if status == "failed":
        return tell_many("{n} failed", "{n} failed", count)
    return tell_many("{n} not judged", "{n} not judged", count)


def outcome(key: str) -> str:
    """How a run ended, for people."""
    return told(OUTCOMES.get(key, key))


def clock(time: str) -> str:
    """The clock of a run, for people: the word before "time"."""
    return told(CLOCKS.get(time, time))


def isolation(name: str) -> str:
    """How a run was confined and kept apart, for people; see `grader.run.stage.Stage`."""
    return _CONFINED.sub(lambda found: told(Phrase(found[0], CONFINED[found[0]])), name)


def points(value: float) -> str:
    """Points for people: '12.5'."""
    return number(text.points(value))


def title_of(verdict: Verdict) -> str:
    """What its check asks for; its name where that has no title."""
    return verdict.title or verdict.check


def score_text(verdict: Verdict) -> str:
    """The points: '12.5 / 30'."""
    return f"{points(verdict.score)} / {points(verdict.max_score)}"


def all_passed(checks: int) -> str:
    """That nothing is to be mended: 'all 7 checks passed.'."""
    return tell_many("the only check passed.", "all {n} checks passed.", checks)


def where(evidence: Evidence) -> str:
    """Time and place: 'at 12.34 s, at (5.54, 7.20)'."""
    place = text.place(evidence.x, evidence.y)
    if not evidence.run:
        return tell("at {time_s:.2f} s, at {place}", time_s=evidence.time_s, place=place)
    return tell(
        "varied run {run}, at {time_s:.2f} s, at {place}",
        run=evidence.run,
        time_s=evidence.time_s,
        place=place,
    )


def nothing_to_mend(passed: int, left_out: NotShown | None) -> str:
    """The headline where all verdicts that are shown passed."""
    if left_out is None:
        return tell("Nothing to mend: {all_passed}", all_passed=all_passed(passed))
    others = tell_many("{n:,} check is not shown", "{n:,} checks are not shown", left_out.checks)
    if not passed:
        return tell("Nothing is shown here: {others}.", others=others)
    some = tell_many("{n:,} check passed", "{n:,} checks passed", passed)
    return tell("Nothing to mend in what is shown: {some}; {others}.", some=some, others=others)


def not_shown(left_out: NotShown | None) -> str:
    """That there are more checks than those that are shown; '' where there are none."""
    if left_out is None:
        return ""
    checks, later = left_out.checks, left_out.until_due
    said = tell_many(
        "{n:,} check worth {points} points is not shown here, nor counted in this score",
        "{n:,} checks worth {points} points are not shown here, nor counted in this score",
        checks,
        points=points(left_out.max_score),
    )
    if not later:
        return tell("{said}.", said=said)
    if later == checks:
        return tell("{said}; shown when the exercise is over.", said=said)
    return tell_many(
        "{said}; {n} of them is shown when the exercise is over.",
        "{said}; {n} of them are shown when the exercise is over.",
        later,
        said=said,
    )


def handed_in(result: Result) -> list[str]:
    """Whose a result is, and what it costs that it came late; nothing where nobody has said it."""
    found = result.handed_in
    if found is None:
        return []
    who = {"who": found.name or found.id, "attempt": found.attempt}
    if found.at:
        when = found.at.replace("T", " ")
        said = [tell("{who}, attempt {attempt}, handed in {when}.", **who, when=when)]
    else:
        said = [tell("{who}, attempt {attempt}.", **who)]
    if found.late_s <= 0:
        return said
    late = duration(found.late_s)
    if not found.deducted:
        return [*said, tell("Handed in {late} late, which costs no points.", late=late)]
    less = points(found.deducted)
    if result.not_shown is not None:  # of a total from which what is hidden could be told
        return [
            *said,
            tell(
                "Handed in {late} late: {less} points less in the total of all checks.",
                late=late,
                less=less,
            ),
        ]
    return [
        *said,
        tell(
            "Handed in {late} late: {less} points less; {final} instead of {score}.",
            late=late,
            less=less,
            final=points(result.final),
            score=points(result.score),
        ),
    ]


def duration(seconds: float) -> str:
    """A time that people count in days, hours and minutes: '1 day 3 h', '2 h 10 min', '40 s'."""
    if seconds < 60:
        return tell("{seconds:.0f} s", seconds=max(seconds, 1))
    minutes = int(seconds // 60)
    days, hours, minutes = minutes // 1440, minutes // 60 % 24, minutes % 60
    parts = [
        tell_many("{n:,} day", "{n:,} days", days) if days else "",
        tell("{hours} h", hours=hours) if hours else "",
        tell("{minutes} min", minutes=minutes) if minutes and not days else "",
    ]
    return " ".join(part for part in parts if part)
