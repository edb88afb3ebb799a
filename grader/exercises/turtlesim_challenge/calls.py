"""How often the pen is changed."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Finding
from grader.exercises.turtlesim_challenge.path import CENTRE_M, Path
from grader.exercises.turtlesim_challenge.rate import by_what_is_shown
from turtlesim_py.world.events import SetPen
from turtlesim_py.world.turtle import TICK_S


def judge_calls(path: Path, tolerances: Tolerances) -> Finding:
    """Whether set_pen is called about as often as a quadrant is entered."""
    calls = path.calls(SetPen)
    if not calls:
        return Finding(0, "set_pen was never called.", "Call it once for each quadrant entered.")
    if all(call.off for call in calls):
        return Finding(
            0,
            f"All {len(calls)} calls of set_pen switch the pen off: none gives it a colour.",
            "What do your requests say of `off`? 0 is a pen that draws.",
            (path.at(calls[0].tick, "the pen is switched off here"),),
        )
    # Near the start the count of entries depends on where exactly the centre is taken to be.
    counts = [len(path.entries(0.0, centre)) for centre in (CENTRE_M, *tolerances["centres_m"])]
    needed = max(counts)
    if len(calls) <= needed + tolerances["spare_calls"]:
        text = f"{len(calls)} calls for {counts[0]} entries."
        return by_what_is_shown(path, tolerances, text)
    useless = [b for a, b in pairwise(calls) if _same_pen(a, b)]
    first = (useless or calls[needed:])[0]
    return Finding(
        0,
        f"set_pen was called {len(calls)} times; {counts[0]} were needed. The first needless call "
        f"came at {first.tick * TICK_S:.2f} s.",
        "Remember the quadrant of the last call, and call only when it changes.",
        (path.at(first.tick, "a call that was not needed"),),
    )


def _same_pen(earlier: SetPen, later: SetPen) -> bool:
    return replace(earlier, tick=later.tick) == later
