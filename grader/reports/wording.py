"""The words for verdicts, points and runs, the same in all formats."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Final

from grader.exercise.result.result import NotShown, Result, ResultProvenance
from grader.exercise.verdict import Evidence, Verdict
from grader.recording.recording import Run
from grader.text import strings as text
from grader.text.message import in_context, msg
from grader.text.translations import number, tr, translate

WORDS: Final = {
    "passed": msg("passed"),
    "failed": msg("failed"),
    "not_judged": msg("not judged"),
}
#: For teachers: what students see of a verdict that they do not see, or not all of.
SEEN_BY_STUDENTS: Final = {
    "after_due": msg("students see it when the exercise is over"),
    "points_only": msg("students see its points alone"),
    "never": msg("students never see it"),
}
#: In place of a check's hint where the first line has the cause.
SEE_FIRST: Final = msg("See the first line.")
#: The outcome of a run that ended because nothing had moved.
NOTHING_MOVED: Final = "nothing moved"
#: How a run ended, by `Report.outcome`.
OUTCOMES: Final = {
    "finished": msg("finished"),
    "exited": msg("exited"),
    "crashed": msg("crashed"),
    "stalled": msg("stalled"),
    "time limit": msg("time limit"),
    "killed": msg("killed"),
    "not run": msg("not run"),
    NOTHING_MOVED: msg("nothing moved"),
}
#: The clock of a run.
CLOCKS: Final = {"virtual": msg("virtual"), "real": msg("real")}
#: How a run was confined and isolated; a result file combines these.
CONFINED: Final = {
    "namespaces": in_context("namespaces", "of a run"),
    "limits": in_context("limits", "of a run"),
    "own user": msg("own user"),
    "private network": msg("private network"),
    "ROS domain": msg("ROS domain"),
    "process group": msg("process group"),
    "process tree": msg("process tree"),
    "recording within reach": msg("recording within reach"),
}
_CONFINED: Final = re.compile("|".join(CONFINED))


def word(verdict: Verdict) -> str:
    return translate(WORDS[verdict.status])


def so_many(status: str, count: int) -> str:
    """Count the verdicts of a status: '6 passed'."""
    if status == "passed":
        return tr("{n} passed", "{n} passed", n=count)
    if status == "failed":
        return tr("{n} failed", "{n} failed", n=count)
    return tr("{n} not judged", "{n} not judged", n=count)


def outcome_text(key: str) -> str:
    return translate(OUTCOMES.get(key, key))


def clock(time: str) -> str:
    """Return the clock of a run, for people: the word before "time"."""
    return translate(CLOCKS.get(time, time))


def how_it_ran(run: Run, outcome: str) -> str:
    """Return how a run went, in a line; where its duration is not known, without it."""
    values = {"outcome": outcome, "simulated_s": run.simulated_s, "clock": clock(run.time)}
    if not run.wall_s:
        return tr("Run: {outcome}, {simulated_s:.1f} s simulated ({clock} time).", **values)
    return tr(
        "Run: {outcome}, {simulated_s:.1f} s simulated in {wall_s:.1f} s ({clock} time).",
        wall_s=run.wall_s,
        **values,
    )


def isolation(name: str) -> str:
    """Return how a run was confined and isolated, for people; see `grader.run.run_context`."""
    return _CONFINED.sub(lambda found: translate(CONFINED[found[0]]), name)


def points(value: float) -> str:
    """Format points for people: '12.5'."""
    return number(text.points(value))


def run_name(number: int) -> str:
    """Name a run; 0 is the nominal one."""
    return tr("Varied run {number}", number=number) if number else tr("Nominal run")


def with_drawn(title: str, drawn: Mapping[str, object]) -> str:
    """Add what was drawn for a run to its title."""
    values = ", ".join(f"{name} = {value}" for name, value in drawn.items())
    return tr("{title}; drawn: {values}", title=title, values=values) if values else title


def title_of(verdict: Verdict) -> str:
    """Return the title of a verdict's check; its name where it has no title."""
    return translate(verdict.title) or verdict.check


def score_text(verdict: Verdict) -> str:
    """Format the points of a verdict: '12.5 / 30'."""
    return f"{points(verdict.score)} / {points(verdict.max_score)}"


def all_passed(checks: int) -> str:
    """Return 'all 7 checks passed.'."""
    return tr("the only check passed.", "all {n} checks passed.", n=checks)


def where(evidence: Evidence) -> str:
    """Return time and place of evidence: 'at 12.34 s, at (5.54, 7.20)'."""
    if evidence.place is None:
        if not evidence.run:
            return tr("at {time_s:.2f} s", time_s=evidence.time_s)
        return tr("varied run {run}, at {time_s:.2f} s", run=evidence.run, time_s=evidence.time_s)
    place = text.place(*evidence.place)
    if not evidence.run:
        return tr("at {time_s:.2f} s, at {place}", time_s=evidence.time_s, place=place)
    return tr(
        "varied run {run}, at {time_s:.2f} s, at {place}",
        run=evidence.run,
        time_s=evidence.time_s,
        place=place,
    )


def nothing_to_mend(passed: int, left_out: NotShown | None) -> str:
    """Return the headline where all shown verdicts passed."""
    if left_out is None:
        return tr("Nothing to fix: {all_passed}", all_passed=all_passed(passed))
    others = tr("{n:,} check is not shown", "{n:,} checks are not shown", n=left_out.checks)
    if not passed:
        return tr("Nothing is shown here: {others}.", others=others)
    some = tr("{n:,} check passed", "{n:,} checks passed", n=passed)
    return tr("Nothing to fix in what is shown: {some}; {others}.", some=some, others=others)


def not_shown(left_out: NotShown | None) -> str:
    """Return the sentence on the checks that are not shown; '' where there are none."""
    if left_out is None:
        return ""
    checks, later = left_out.checks, left_out.until_due
    sentence = tr(
        "{n:,} check worth {points} points is not shown here, nor counted in this score",
        "{n:,} checks worth {points} points are not shown here, nor counted in this score",
        n=checks,
        points=points(left_out.max_score),
    )
    if not later:
        return tr("{said}.", said=sentence)
    if later == checks:
        return tr("{said}; shown when the exercise is over.", said=sentence)
    return tr(
        "{said}; {n} of them is shown when the exercise is over.",
        "{said}; {n} of them are shown when the exercise is over.",
        n=later,
        said=sentence,
    )


def attempt(result: Result) -> list[str]:
    """Return whose attempt a result is, and the deduction for lateness; [] where it is unknown."""
    info = result.handed_in
    if info is None:
        return []
    who = {"who": info.name or info.id, "attempt": info.attempt}
    if info.at:
        when = info.at.isoformat(" ")
        sentence = tr("{who}, attempt {attempt}, handed in {when}.", **who, when=when)
    else:
        sentence = tr("{who}, attempt {attempt}.", **who)
    if info.late_s <= 0 and not info.days:
        return [sentence]
    late = duration(info.late_s) if info.late_s > 0 else tr("some time")
    values = {"late": late, "less": points(info.deducted)}
    if not info.deducted:
        cost = tr("Handed in {late} late, which costs no points.", **values)
    elif result.not_shown is not None:  # the total would reveal the points of hidden checks
        cost = tr("Handed in {late} late: {less} points less in the total of all checks.", **values)
    else:
        values |= {"final": points(result.final), "score": points(result.score)}
        cost = tr(
            "Handed in {late} late: {less} points less; {final} instead of {score}.", **values
        )
    return [sentence, cost]


def duration(seconds: float) -> str:
    """Format a duration in days, hours and minutes: '1 day 3 h', '2 h 10 min', '40 s'."""
    if seconds < 60:
        return tr("{seconds:.0f} s", seconds=max(seconds, 1))
    minutes = int(seconds // 60)
    days, hours, minutes = minutes // 1440, minutes // 60 % 24, minutes % 60
    parts = [
        tr("{n:,} day", "{n:,} days", n=days) if days else "",
        tr("{hours} h", hours=hours) if hours else "",
        tr("{minutes} min", minutes=minutes) if minutes and not days else "",
    ]
    return " ".join(part for part in parts if part)


#: So many digits of a hash are shown; the result file has all.
_DIGITS = 12


def provenance(origin: ResultProvenance) -> list[str]:
    """Return when, with which versions, and of which inputs a result was made."""
    judged, recorded = origin.judged, origin.recorded
    found = []
    if recorded is not None:
        ros = f", ROS 2 {recorded.ros_distro}" if recorded.ros_distro else ""
        found.append(
            tr(
                "Run {when} with grader {grader}, Python {python}, rclpy {rclpy}{ros}",
                when=_when(recorded.date),
                grader=recorded.grader,
                python=recorded.python,
                rclpy=recorded.rclpy,
                ros=ros,
            )
        )
    found.append(
        tr("Judged {when} by grader {grader}", when=_when(judged.date), grader=judged.grader)
    )
    if recorded is not None:
        sha256 = _short(recorded.submission_sha256)
        found.append(tr("SHA-256 of the submission {sha256}", sha256=sha256))
    sha256 = _short(judged.exercise_sha256)
    found.append(tr("SHA-256 of the exercise {sha256}", sha256=sha256))
    if recorded is not None and recorded.seed is not None:
        found.append(tr("Seed {seed}", seed=str(recorded.seed)))
    return [text.one_line(sentence) for sentence in found]


def _when(date: str) -> str:
    """Format a date like '2026-11-21T23:52:52Z' for people."""
    date, _, time = date.partition("T")
    year, _, rest = date.partition("-")
    month, _, day = rest.partition("-")
    return tr("{year}-{month}-{day} at {time} UTC", year=year, month=month, day=day, time=time[:5])


def _short(sha256: str) -> str:
    return f"{sha256[:_DIGITS]}…" if sha256 else tr("unknown")
