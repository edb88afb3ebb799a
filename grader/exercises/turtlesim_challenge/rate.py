"""Judges the rate of velocity commands, and the number of calls of set_pen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Finding
from grader.exercises.turtlesim_challenge import shape
from grader.exercises.turtlesim_challenge.commands import WATCHDOG_TICKS
from grader.exercises.turtlesim_challenge.path import CENTRE_M, Path
from grader.text.message import Message, joined, msg
from turtlesim_py.world.events import CmdVel, SetPen
from turtlesim_py.world.turtle import TICK_S


def judge_rate(path: Path, tolerances: Tolerances) -> Finding:
    """Judge whether the commands came regularly, until the turtle drove no more."""
    ticks = np.array([c.tick for c in path.calls(CmdVel) if c.tick <= path.stop_tick + 1])
    if len(ticks) < 3:
        text = msg("Fewer than three commands ({commands}) have no rate.", commands=len(ticks))
        return Finding(0, text, msg("Use a timer."))
    gaps = np.diff(ticks)
    if gaps.max() > WATCHDOG_TICKS:
        row = int(np.argmax(gaps > WATCHDOG_TICKS))
        return Finding(
            0,
            msg(
                "No command came for {gap_s:.2f} s, and the turtle paused on its way: "
                "a command moves it for one second only.",
                gap_s=gaps[row] * TICK_S,
            ),
            msg("Publish at a fixed rate, faster than once a second."),
            (path.at(int(ticks[row]) + WATCHDOG_TICKS, msg("it stands still here")),),
        )
    median = float(np.median(gaps))
    if not median:
        return Finding(
            0,
            msg(
                "{commands} commands came in {seconds:.1f} s, several in each step of the "
                "simulator: nothing makes your node wait between them.",
                commands=len(ticks),
                seconds=(ticks[-1] - ticks[0]) * TICK_S,
            ),
            msg("A timer keeps the rate fixed."),
            (path.at(int(ticks[0]), msg("here it begins to publish")),),
        )
    allowed = max(tolerances["rate_deviation"] * median, 1.5)
    regular = float(np.mean(np.abs(gaps - median) <= allowed))
    if regular < tolerances["rate_share"]:
        return Finding(
            0,
            msg(
                "The time between commands varies: usually it is {usual_s:.2f} s, but only "
                "{regular} of the intervals are near that; {wanted} are asked for.",
                usual_s=median * TICK_S,
                regular=_percent(regular),
                wanted=_percent(tolerances["rate_share"]),
            ),
            msg("A timer keeps the rate fixed, as long as no callback takes long."),
        )
    text = msg("A command every {usual_s:.2f} s.", usual_s=median * TICK_S)
    return by_what_is_shown(path, tolerances, text)


def by_what_is_shown(path: Path, tolerances: Tolerances, text: Message) -> Finding:
    """All of the points, or, for a path with few turns, a part of them."""
    share = shape.shown(path, tolerances)
    if share >= 1:
        return Finding(1, text)
    wanted = {"turns": tolerances["turns"]}
    more = msg(
        "But the path has fewer than the {turns:g} turns that are asked for: that tells nothing "
        "yet.",
        **wanted,
    )
    if share:
        more = msg(
            "But the path has fewer than the {turns:g} turns that are asked for: that is worth "
            "{share} of the points.",
            share=_percent(share),
            **wanted,
        )
    help_ = msg("Look at the path first: this counts in full when all of it is driven.")
    return Finding(share, joined([text, more], " "), help_)


def _percent(share: float) -> str:
    return f"{int(100 * share + 1e-9)} %"


#: Calls that follow one another so soon belong to one entry.
AT_ONCE_TICKS = 5
#: So many calls for each entry are no longer two where one is enough.
MANY = 4


def judge_calls(path: Path, tolerances: Tolerances) -> Finding:
    """Judge whether set_pen is called about as often as a quadrant is entered."""
    calls = path.calls(SetPen)
    if not calls:
        return Finding(
            0, msg("set_pen was never called."), msg("Call it once for each quadrant entered.")
        )
    if all(call.off for call in calls):
        return Finding(
            0,
            msg(
                "The {n} call of set_pen switches the pen off: none gives it a colour.",
                "All {n} calls of set_pen switch the pen off: none gives it a colour.",
                n=len(calls),
            ),
            msg("What do your requests say of `off`? 0 is a pen that draws."),
            (path.at(calls[0].tick, msg("the pen is switched off here")),),
        )
    # Near the start the count of entries depends on where exactly the centre is assumed.
    counts = [len(path.entries(0.0, centre)) for centre in (CENTRE_M, *tolerances["centres_m"])]
    needed = max(counts)
    if len(calls) <= needed + tolerances["spare_calls"]:
        text = msg(
            "{calls} for {entries}.",
            calls=msg("{n} call", "{n} calls", n=len(calls)),
            entries=msg("{n} entry", "{n} entries", n=counts[0]),
        )
        if len(calls) + tolerances["spare_calls"] < min(counts):
            help_ = msg("Call it at each entry into another quadrant, not only at the first.")
            return Finding(len(calls) / min(counts), text, help_)
        return by_what_is_shown(path, tolerances, text)
    useless = [b for a, b in pairwise(calls) if replace(a, tick=b.tick) == b]
    first = (useless or calls[needed:])[0]
    bursts = 1 + sum(b.tick - a.tick > AT_ONCE_TICKS for a, b in pairwise(calls))
    if bursts <= needed + tolerances["spare_calls"] and len(calls) < MANY * bursts:
        return _several_at_once(path, calls, counts[0])
    return Finding(
        0,
        msg(
            "set_pen was called {calls} times; {needed} were needed. The first needless call "
            "came at {time_s:.2f} s.",
            calls=len(calls),
            needed=counts[0],
            time_s=first.tick * TICK_S,
        ),
        msg("Remember the quadrant of the last call, and call only when it changes."),
        (path.at(first.tick, msg("a call that was not needed")),),
    )


def _several_at_once(path: Path, calls: Sequence[SetPen], needed: int) -> Finding:
    second = next(b for a, b in pairwise(calls) if b.tick - a.tick <= AT_ONCE_TICKS)
    return Finding(
        0,
        msg(
            "set_pen was called {calls} times, more than once at each entry; {needed} were needed.",
            calls=len(calls),
            needed=needed,
        ),
        msg("One call at each entry is enough, not two: a request says colour, width and `off`."),
        (path.at(second.tick, msg("the second call at once")),),
    )
