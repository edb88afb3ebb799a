"""How often the pen is changed."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

from grader.exercise.check import Tolerances
from grader.exercise.sentences import counted
from grader.exercise.verdict import Finding
from grader.exercises.turtlesim_challenge.path import CENTRE_M, Path
from grader.exercises.turtlesim_challenge.rate import by_what_is_shown
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
        return Finding(0, "set_pen was never called.", "Call it once for each quadrant entered.")
    if all(call.off for call in calls):
        return Finding(
            0,
            f"{'All' if len(calls) > 1 else 'The'} {counted(len(calls), 'call')} of set_pen "
            f"switch{'' if len(calls) > 1 else 'es'} the pen off: none gives it a colour.",
            "What do your requests say of `off`? 0 is a pen that draws.",
            (path.at(calls[0].tick, "the pen is switched off here"),),
        )
    # Near the start the count of entries depends on where exactly the centre is taken to be.
    counts = [len(path.entries(0.0, centre)) for centre in (CENTRE_M, *tolerances["centres_m"])]
    needed = max(counts)
    if len(calls) <= needed + tolerances["spare_calls"]:
        text = f"{counted(len(calls), 'call')} for {counted(counts[0], 'entry', 'entries')}."
        return by_what_is_shown(path, tolerances, text)
    useless = [b for a, b in pairwise(calls) if _same_pen(a, b)]
    first = (useless or calls[needed:])[0]
    bursts = 1 + sum(b.tick - a.tick > AT_ONCE_TICKS for a, b in pairwise(calls))
    if bursts <= needed + tolerances["spare_calls"] and len(calls) < MANY * bursts:
        second = next(b for a, b in pairwise(calls) if b.tick - a.tick <= AT_ONCE_TICKS)
        return Finding(
            0,
            f"set_pen was called {len(calls)} times, more than once at each entry; "
            f"{counts[0]} were needed.",
            "One call at each entry is enough, not two: a request says colour, width and `off`.",
            (path.at(second.tick, "the second call at once"),),
        )
    return Finding(
        0,
        f"set_pen was called {len(calls)} times; {counts[0]} were needed. The first needless call "
        f"came at {first.tick * TICK_S:.2f} s.",
        "Remember the quadrant of the last call, and call only when it changes.",
        (path.at(first.tick, "a call that was not needed"),),
    )


def _same_pen(earlier: SetPen, later: SetPen) -> bool:
    return replace(earlier, tick=later.tick) == later
