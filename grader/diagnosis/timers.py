"""Rules about timers: one that is yet to come, and one that is made again and again."""

from __future__ import annotations

from grader.diagnosis.case import Case, function, line
from grader.diagnosis.diagnosis import Diagnosis
from grader.language.phrase import say

#: A timer that a program drives by comes sooner than that [s].
_LONG_S = 5.0
#: Who makes one after the other makes fewer a second.
_MOST_PER_S = 30.0


def waits_for_timer(case: Case) -> Diagnosis | None:
    """It sends nothing, and has a timer whose time does not come."""
    publishers = [end for end in case.conduct.ends if end.kind == "publisher"]
    if not publishers or any(end.used for end in publishers):
        return None
    run_s = case.run.simulated_s
    timers = case.conduct.timers
    if not timers or any(timer.period_s < max(_LONG_S, run_s) for timer in timers):
        return None
    timer = timers[0]
    cause = say(
        "Your timer{where} has a period of {period_s:g} s: in {run_s:.0f} s it has not come once.",
        where=line(timer.place),
        period_s=timer.period_s,
        run_s=run_s,
    )
    help_ = say("create_timer() takes seconds, not milliseconds: 0.1 is ten times a second.")
    return Diagnosis("waits_for_timer", cause, help_, place=timer.place)


def makes_timers(case: Case) -> Diagnosis | None:
    """It makes a timer each time that something is called, and all of them go on."""
    for timer in case.conduct.timers:
        if timer.times < _MOST_PER_S * max(case.run.simulated_s, 1.0):
            continue
        each_time = ""
        if name := function(timer.place):
            each_time = say(" each time that {name} is called", name=name)
        cause = say(
            "You make a new timer{each_time}{where}: {times} of them, and each goes on calling.",
            each_time=each_time,
            where=line(timer.place),
            times=timer.times,
        )
        help_ = say("Make it once, in __init__: it calls again and again by itself.")
        return Diagnosis("makes_timers", cause, help_, place=timer.place)
    return None
