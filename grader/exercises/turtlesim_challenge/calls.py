"""How often the pen is changed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Finding
from grader.exercises.turtlesim_challenge.path import CENTRE_M, Path
from grader.exercises.turtlesim_challenge.rate import by_what_is_shown
from grader.language.phrase import say, say_many
from turtlesim_py.world.events import SetPen
from turtlesim_py.world.turtle import TICK_S

#: Calls that follow one another so soon belong to one entry.
AT_ONCE_TICKS = 5
#: So many calls for each entry are no longer two where one is enough.
MANY = 4


def judge_calls(path: Path, tolerances: Tolerances) -> Finding:
    """Whether set_pen is called about as often as a quadrant is entered."""
    calls = path.calls(SetPen)
    if not calls:
        return Finding(
            0, say("set_pen was never called."), say("Call it once for each quadrant entered.")
        )
    if all(call.off for call in calls):
        return Finding(
            0,
            say_many(
                "The {n} call of set_pen switches the pen off: none gives it a colour.",
                "All {n} calls of set_pen switch the pen off: none gives it a colour.",
                len(calls),
            ),
            say("What do your requests say of `off`? 0 is a pen that draws."),
            (path.at(calls[0].tick, say("the pen is switched off here")),),
        )
    # Near the start the count of entries depends on where exactly the centre is taken to be.
    counts = [len(path.entries(0.0, centre)) for centre in (CENTRE_M, *tolerances["centres_m"])]
    needed = max(counts)
    if len(calls) <= needed + tolerances["spare_calls"]:
        text = say(
            "{calls} for {entries}.",
            calls=say_many("{n} call", "{n} calls", len(calls)),
            entries=say_many("{n} entry", "{n} entries", counts[0]),
        )
        return by_what_is_shown(path, tolerances, text)
    useless = [b for a, b in pairwise(calls) if _same_pen(a, b)]
    first = (useless or calls[needed:])[0]
    bursts = 1 + sum(b.tick - a.tick > AT_ONCE_TICKS for a, b in pairwise(calls))
    if bursts <= needed + tolerances["spare_calls"] and len(calls) < MANY * bursts:
        return _several_at_once(path, calls, counts[0])
    return Finding(
        0,
        say(
            "set_pen was called {calls} times; {needed} were needed. The first needless call "
            "came at {time_s:.2f} s.",
            calls=len(calls),
            needed=counts[0],
            time_s=first.tick * TICK_S,
        ),
        say("Remember the quadrant of the last call, and call only when it changes."),
        (path.at(first.tick, say("a call that was not needed")),),
    )


def _several_at_once(path: Path, calls: Sequence[SetPen], needed: int) -> Finding:
    second = next(b for a, b in pairwise(calls) if b.tick - a.tick <= AT_ONCE_TICKS)
    return Finding(
        0,
        say(
            "set_pen was called {calls} times, more than once at each entry; {needed} were needed.",
            calls=len(calls),
            needed=needed,
        ),
        say("One call at each entry is enough, not two: a request says colour, width and `off`."),
        (path.at(second.tick, say("the second call at once")),),
    )


def _same_pen(earlier: SetPen, later: SetPen) -> bool:
    return replace(earlier, tick=later.tick) == later
