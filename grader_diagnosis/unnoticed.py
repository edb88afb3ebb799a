"""Rules about what goes wrong unnoticed: caught exceptions, idle coroutines, timers."""

from __future__ import annotations

import re
from pathlib import PurePath

from grader.exercise import Diagnosis
from grader.recording.observations import Caught, SourceLine, is_library
from grader.text import NOTHING, Message, joined, msg, shown
from grader_diagnosis.case import Case, after, diagnosed, function, sentences
from grader_diagnosis.known_exceptions import explain

#: A program that ends so soon after an exception has ended by it [s].
_SOON_S = 1.0
#: Exceptions that no program counts on.
_MISTAKES = (
    *("NameError", "UnboundLocalError", "AttributeError", "TypeError", "AssertionError"),
    *("ZeroDivisionError", "ImportError", "ModuleNotFoundError"),
)
#: What is None until the first message has come is gone after so many times.
_OFTEN = 8
_NEVER_AWAITED = re.compile(
    r"^(?P<file>[^\n:]{1,1000}):(?P<line>\d{1,9}): RuntimeWarning: "
    r"coroutine '(?P<name>[\w.<>]{1,200})' was never awaited(?:\n  (?P<text>[^\n]{1,300}))?",
    re.MULTILINE,
)
#: A timer that a program drives by comes sooner than that [s].
_LONG_PERIOD_S = 5.0
#: The simulator moves the turtle once in 16 ms; a node that drives by the clock needs no more.
_SHORT_PERIOD_S = 0.005
#: A program that makes timers on purpose makes fewer a second.
_MOST_TIMERS_PER_S = 30.0
NOT_CAUGHT = msg("Without the try/except Python would say so itself.")


def ended_by_caught(case: Case) -> Diagnosis | None:
    """The program ended by an exception that it caught itself."""
    ended_s = case.ended_s
    if ended_s is None or case.observed.raised is not None:
        return None
    for caught in case.observed.caught:
        if 0 <= ended_s - caught.time_s <= _SOON_S:
            return diagnosed(
                "ended_by_caught",
                msg("Your program caught an exception, and so ended {after}: {error}{where}."),
                _help(caught),
                caught.place,
                ended_s,
                after=after(ended_s),
                error=_error(caught),
            )
    return None


def hides_errors(case: Case) -> Diagnosis | None:
    """A callback fails again and again, and the program catches that and goes on."""
    for caught in case.observed.caught:
        often = _OFTEN if "NoneType" in caught.text else 2
        if caught.times < often or caught.type not in _MISTAKES:
            continue
        return diagnosed(
            "hides_errors",
            msg(
                "{who} fails, and something in your program catches that and goes on: "
                "{error}{where}."
            ),
            _help(caught),
            caught.place,
            who=function(caught.place) or msg("A callback"),
            error=_error(caught),
        )
    return None


def never_awaits(case: Case) -> Diagnosis | None:
    """The program calls an `async def` like any function: nothing of it is ever run."""
    for found in _NEVER_AWAITED.finditer(case.tail):
        if is_library(found["file"]):
            continue
        text = (found["text"] or "").strip()
        place = SourceLine(PurePath(found["file"]).name, int(found["line"]), "", text)
        return diagnosed(
            "never_awaits",
            msg(
                "An `async def` that nobody awaits was called{where}: nothing of {name}() was run."
            ),
            msg(
                "Make it a plain `def {name}`: call_async(request) in it sends the "
                "request, and you go on without waiting for the answer."
            ),
            place,
            name=shown(found["name"].rpartition(".")[2]),
        )
    return None


def waits_for_timer(case: Case) -> Diagnosis | None:
    """The program sends nothing, and has a timer whose period is longer than the run."""
    publishers = [end for end in case.observed.ends if end.kind == "publisher"]
    if not publishers or any(end.used for end in publishers):
        return None
    run_s = case.run.simulated_s
    timers = case.observed.timers
    if not timers or any(timer.period_s < max(_LONG_PERIOD_S, run_s) for timer in timers):
        return None
    return diagnosed(
        "waits_for_timer",
        msg(
            "Your timer{where} has a period of {period_s:g} s: in {run_s:.0f} s it has not come "
            "once."
        ),
        msg("create_timer() takes seconds, not milliseconds: 0.1 is ten times a second."),
        timers[0].place,
        period_s=timers[0].period_s,
        run_s=run_s,
    )


def hurries(case: Case) -> Diagnosis | None:
    """The program has a timer that comes in every tick of the simulator, or more often."""
    for timer in case.observed.timers:
        if timer.period_s < _SHORT_PERIOD_S:
            return diagnosed(
                "hurries",
                msg(
                    "Your timer{where} has a period of {period_s:g} s: it comes as often as it can."
                ),
                msg("create_timer() takes seconds: 0.1 is ten times a second."),
                timer.place,
                period_s=timer.period_s,
            )
    return None


def makes_timers(case: Case) -> Diagnosis | None:
    """The program makes a timer each time that a function is called, and all of them go on."""
    for timer in case.observed.timers:
        if timer.times < _MOST_TIMERS_PER_S * max(case.run.simulated_s, 1.0):
            continue
        each_time = NOTHING
        if name := function(timer.place):
            each_time = msg(" each time that {name} is called", name=name)
        return diagnosed(
            "makes_timers",
            msg(
                "You create a new timer{each_time}{where}: {times} of them, and each keeps firing."
            ),
            msg("Make it once, in __init__: it calls again and again by itself."),
            timer.place,
            each_time=each_time,
            times=timer.times,
        )
    return None


def _error(caught: Caught) -> Message:
    text = explain(caught).text or Message.of(shown(caught.text).rstrip("."))
    return joined([shown(caught.type), text] if text else [shown(caught.type)], ": ")


def _help(caught: Caught) -> Message:
    return sentences(explain(caught).help, NOT_CAUGHT)
