"""Finds the earliest cause of lost points: applies one rule after another, each for one mistake.

The rules stand in the order in which things happen in the life of a program: Python reads it, it
imports, it finds the others, it spins, it waits. A crash names its own cause, and comes before what
may or may not have led to it; only one for want of a message comes after the rule whether any could
come. A rule returns None when it is not sure.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType
from typing import Final

from grader import Recordings, Verdict
from grader.exercise import Diagnosis, costliest
from grader.recording import Endpoint
from grader.text import msg, one_line, shown
from grader_diagnosis import (
    connections,
    crash,
    imports,
    lint_findings,
    lost_points,
    standstill,
    unnoticed,
)
from grader_diagnosis.case import Case, first_of, line, sentences

Rule = Callable[[Case], Diagnosis | None]
#: Rules about what keeps a run from going on.
RULES: Final[tuple[Rule, ...]] = (
    crash.unreadable,
    imports.not_importable,
    crash.unanswered,
    crash.wrong_value,
    lint_findings.ends_before_spin,
    connections.is_defined_otherwise,
    connections.misses_what_it_hears,
    connections.is_too_early,
    crash.ended_itself,
    connections.is_of_another_type,
    crash.crashed,
    standstill.sends_too_much,
    crash.killed,
    crash.thread_crashed,
    unnoticed.ended_by_caught,
    standstill.starts_what_is_not_there,
    connections.waits_in_vain,
    connections.publishes_to_nobody,
    connections.has_unfit_qos,
    connections.hears_nobody,
    connections.calls_nobody,
    standstill.does_nothing,
    standstill.stuck_in_callback,
    lint_findings.unstarted,
    standstill.stuck_in_call,
    standstill.endless_loop,
    lint_findings.called_at_once,
    lint_findings.spins_in_init,
    standstill.stays_in_init,
    standstill.spins_in_loop,
    standstill.never_spins,
    standstill.ends_early,
    unnoticed.waits_for_timer,
)
#: Rules about what only disturbs a run; applied when nothing keeps any run from going on.
DISTURBING: Final[tuple[Rule, ...]] = (
    unnoticed.hides_errors,
    unnoticed.never_awaits,
    unnoticed.makes_timers,
    unnoticed.hurries,
    standstill.publishes_without_waiting,
    standstill.slow_callback,
    lint_findings.awaits,
    standstill.hears_once,
)


def diagnose(
    recordings: Recordings,
    verdicts: Sequence[Verdict] = (),
    peers_have: Mapping[str, Sequence[Endpoint]] = MappingProxyType({}),
    *,
    is_to_end: bool = False,
) -> Diagnosis | None:
    """Return the earliest cause of lost points; it changes none of them.

    Args:
        recordings: of all runs; a cause in the nominal one comes before one in the others.
        verdicts: of the exercise's checks; without any, only the rules about runs are applied.
        peers_have: what of the exercise's peers a program may meet, by the names of cases.
        is_to_end: whether the exercise asks for a program that ends by itself.

    Returns: None where no point is lost and no program died, or no verdict is known and the runs
        show nothing.
    """
    is_right = bool(verdicts) and all(verdict.passed for verdict in verdicts)
    cases = [Case(each, is_to_end, tuple(peers_have.get(each.run.case, ()))) for each in recordings]
    for rules in (RULES,) if is_right else (RULES, DISTURBING):
        for number, case in enumerate(cases):
            if is_right and case.run.outcome != "crashed":
                continue
            found = next((each for rule in rules if (each := rule(case)) is not None), None)
            if found is not None:
                return _in_run(_at_its_line(found, case), case, number)
    found = costliest(verdicts)
    return found if found is None else _with_source(found, cases[found.run])


def _at_its_line(found: Diagnosis, case: Case) -> Diagnosis:
    """Give a diagnosis the line to change, where the source shows another than the run."""
    lines = {
        "never_spins": "no_spin",
        "ends_early": "spins_once",
        "does_nothing": "uncalled",
    }
    if found.key not in lines or (found.place is not None and "while" in found.place.text):
        return found
    return replace(found, place=first_of(case, lines[found.key]) or found.place)


def _in_run(found: Diagnosis, case: Case, number: int) -> Diagnosis:
    """Add the run's number to a diagnosis, and whose it is; make it fit to be shown."""
    cause = found.cause
    if case.failed is not None:
        cause = msg("{program}: {cause}", program=shown(case.failed.name), cause=cause)
    if number:
        cause = msg("In varied run {number}: {cause}", number=number, cause=cause)
    return _shown(replace(found, run=number, cause=cause))


def _shown(found: Diagnosis) -> Diagnosis:
    place = found.place
    if place is not None:
        place = replace(
            place,
            file=shown(place.file),
            function=shown(place.function),
            text=shown(place.text),
        )
    cause, help_ = one_line(found.cause), one_line(found.help)
    return replace(found, cause=cause, help=help_, place=place)


def _with_source(found: Diagnosis, case: Case) -> Diagnosis:
    """Add to a check's finding what the source shows about its possible cause."""
    with_finding = lost_points.beside(found, case)
    if with_finding is not found:
        return _shown(with_finding)
    with_end = _with_unused(found, case) or _with_timer(found, case)
    return _shown(with_end or _with_place(found, case))


def _with_unused(found: Diagnosis, case: Case) -> Diagnosis | None:
    """Add the publisher or client that a finding names, where it was never used."""
    end = lost_points.unused(found, case)
    if end is None:
        return None
    if end.kind == "publisher":
        unsent = msg("Your publisher{where} has sent no message.", where=line(end.place))
        return replace(found, help=sentences(found.help, unsent), place=end.place)
    unsent = msg("Your client{where} has sent no request.", where=line(end.place))
    cause = sentences(found.cause, unsent)
    made = first_of(case, "unsent")
    if made is None:
        return replace(found, cause=cause, place=end.place)
    help_ = msg("Send the request that you make: call_async(request).")
    return replace(found, cause=cause, help=help_, place=made)


def _with_timer(found: Diagnosis, case: Case) -> Diagnosis | None:
    """Add the period of the only timer to a finding about how often something was sent."""
    is_about_rate = re.search("times a second|messages on ", str(found.cause))
    if is_about_rate is None or len(case.observed.timers) != 1:
        return None
    timer = case.observed.timers[0]
    words = {"where": line(timer.place), "period_s": timer.period_s}
    has = msg("Your timer{where} has a period of {period_s:g} s.", **words)
    return replace(found, cause=sentences(found.cause, has), place=timer.place)


def _with_place(found: Diagnosis, case: Case) -> Diagnosis:
    """Add the line that sends what a finding's text names first."""
    text = found.spoken
    driven_by = {(each.name, each.type) for each in case.scene_has if each.kind == "subscription"}
    first, place = len(text), found.place
    for end in case.observed.ends:
        words = [end.name.rpartition("/")[2], end.type.rpartition("/")[2]]
        patterns = [rf"\b{re.escape(word)}\b" for word in words if word]
        if end.kind == "publisher" and (end.name, end.type) in driven_by:
            patterns += ["command"]
        spoken = (re.search(pattern, text) for pattern in patterns)
        at = min((found.start() for found in spoken if found), default=len(text))
        if at < first and end.used_at is not None:
            first, place = at, end.used_at
    place = lint_findings.set_at(case, text) or place or lint_findings.called_at(case, text)
    return replace(found, place=place)
