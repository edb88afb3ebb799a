"""The rate of the velocity commands."""

from __future__ import annotations

import numpy as np

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Finding
from grader.exercises.turtlesim_challenge import shape
from grader.exercises.turtlesim_challenge.commands import WATCHDOG_TICKS
from grader.exercises.turtlesim_challenge.path import Path
from grader.language.phrase import joined, say
from turtlesim_py.world.events import CmdVel
from turtlesim_py.world.turtle import TICK_S


def judge_rate(path: Path, tolerances: Tolerances) -> Finding:
    """Whether the commands came regularly, until the turtle drove no more."""
    ticks = np.array([c.tick for c in path.calls(CmdVel) if c.tick <= path.stop_tick + 1])
    if len(ticks) < 3:
        text = say("Fewer than three commands ({commands}) have no rate.", commands=len(ticks))
        return Finding(0, text, say("Use a timer."))
    gaps = np.diff(ticks)
    if gaps.max() > WATCHDOG_TICKS:
        row = int(np.argmax(gaps > WATCHDOG_TICKS))
        return Finding(
            0,
            say(
                "No command came for {gap_s:.2f} s, and the turtle paused on its way: "
                "a command moves it for one second only.",
                gap_s=gaps[row] * TICK_S,
            ),
            say("Publish at a fixed rate, faster than once a second."),
            (path.at(int(ticks[row]) + WATCHDOG_TICKS, say("it stands still here")),),
        )
    median = float(np.median(gaps))
    if not median:
        return Finding(
            0,
            say(
                "{commands} commands came in {seconds:.1f} s, several in each step of the "
                "simulator: nothing makes your node wait between them.",
                commands=len(ticks),
                seconds=(ticks[-1] - ticks[0]) * TICK_S,
            ),
            say("A timer keeps the rate fixed."),
            (path.at(int(ticks[0]), say("here it begins to publish")),),
        )
    allowed = max(tolerances["rate_deviation"] * median, 1.5)
    regular = float(np.mean(np.abs(gaps - median) <= allowed))
    if regular < tolerances["rate_share"]:
        return Finding(
            0,
            say(
                "The time between commands varies: usually it is {usual_s:.2f} s, but only "
                "{regular} of the intervals are near that; {wanted} are asked for.",
                usual_s=median * TICK_S,
                regular=_percent(regular),
                wanted=_percent(tolerances["rate_share"]),
            ),
            say("A timer keeps the rate fixed, as long as no callback takes long."),
        )
    text = say("A command every {usual_s:.2f} s.", usual_s=median * TICK_S)
    return by_what_is_shown(path, tolerances, text)


def by_what_is_shown(path: Path, tolerances: Tolerances, text: str) -> Finding:
    """All of the points, or, for a path with few turns, a part of them."""
    share = shape.shown(path, tolerances)
    if share >= 1:
        return Finding(1, text)
    wanted = {"turns": tolerances["turns"]}
    more = say(
        "But the path has fewer than the {turns:g} turns that are asked for: that tells nothing "
        "yet.",
        **wanted,
    )
    if share:
        more = say(
            "But the path has fewer than the {turns:g} turns that are asked for: that is worth "
            "{share} of the points.",
            share=_percent(share),
            **wanted,
        )
    help_ = say("Look at the path first: this counts in full when all of it is driven.")
    return Finding(share, joined([text, more], " "), help_)


def _percent(share: float) -> str:
    return f"{int(100 * share + 1e-9)} %"
