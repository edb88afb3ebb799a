"""Puts the earliest cause first: asks one rule after another, each about one kind of mistake.

The rules stand in the order in which things happen in the life of a program: Python reads it, it
imports, it finds the others, it spins, it waits. A crash says by itself what it is, and comes
before what may or may not have led to it; only one for want of a message waits for the question
whether any could come. A rule is silent when it is not sure.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Final

from grader.diagnosis import connections, crash, standstill, warned
from grader.diagnosis.case import Case, line, told
from grader.diagnosis.costliest import costliest
from grader.diagnosis.diagnosis import Diagnosis
from grader.exercise.verdict import Verdict
from grader.recording.recording import Recordings
from grader.text import one_line

Rule = Callable[[Case], Diagnosis | None]
#: What keeps a run from going on.
RULES: Final[tuple[Rule, ...]] = (
    crash.unreadable,
    crash.not_importable,
    crash.wrong_value,
    connections.misses_what_it_hears,
    crash.ended_itself,
    crash.crashed,
    crash.killed,
    crash.thread_crashed,
    connections.waits_in_vain,
    connections.publishes_to_nobody,
    warned.has_unfit_qos,
    connections.hears_nobody,
    connections.calls_nobody,
    standstill.does_nothing,
    standstill.stuck_in_callback,
    standstill.stuck_in_call,
    standstill.endless_loop,
    standstill.stays_in_init,
    standstill.never_spins,
    standstill.ends_early,
)
#: What only disturbs it; asked when nothing keeps any run from going on.
DISTURBING: Final[tuple[Rule, ...]] = (
    warned.never_awaits,
    standstill.publishes_without_waiting,
    standstill.slow_callback,
    standstill.hears_once,
)


def diagnose(recordings: Recordings, verdicts: Sequence[Verdict] = ()) -> Diagnosis | None:
    """The earliest cause of lost points; it changes none of them.

    Args:
        recordings: of all runs; what is wrong in the nominal one comes before the others.
        verdicts: of the exercise's checks; without any, only what the runs show is looked at.

    Returns: None where no point is lost, or no verdict is known and the runs show nothing.
    """
    if verdicts and all(verdict.passed for verdict in verdicts):
        return None
    cases = [Case(recording) for recording in recordings]
    for rules in (RULES, DISTURBING):
        for number, case in enumerate(cases):
            found = _ask(rules, case)
            if found is not None:
                return _in_run(found, number)
    found = costliest(verdicts)
    return found if found is None else _with_unused(found, cases[found.run])


def _ask(rules: Sequence[Rule], case: Case) -> Diagnosis | None:
    return next((found for rule in rules if (found := rule(case)) is not None), None)


def _in_run(found: Diagnosis, number: int) -> Diagnosis:
    """What was found in a run, fit to be shown."""
    place = found.place
    if place is not None:
        place = replace(
            place, file=told(place.file), function=told(place.function), text=told(place.text)
        )
    where = f"In varied run {number}: " if number else ""
    cause, help_ = one_line(f"{where}{found.cause}"), one_line(found.help)
    return replace(found, run=number, cause=cause, help=help_, place=place)


def _with_unused(found: Diagnosis, case: Case) -> Diagnosis:
    """The finding of a check, with a question where an end that it speaks of was never used."""
    if case.conduct.spun_s is None:
        return found
    there = {(each.name, each.type) for each in case.scene_has}
    for end in case.conduct.ends:
        is_meant = (end.name, end.type) in there and end.name in f"{found.cause} {found.help}"
        if is_meant and not end.used and end.kind in ("publisher", "client"):
            what = "request" if end.kind == "client" else "message"
            asked = (
                f"Your {end.kind}{line(end.place)} has sent no {what}: does a try/except hide an "
                "error?"
            )
            return replace(found, help=one_line(f"{found.help} {asked}".strip()))
    return found
