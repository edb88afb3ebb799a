"""The rate of the velocity commands."""

from __future__ import annotations

import numpy as np

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Finding
from grader.exercises.turtlesim_challenge import shape
from grader.exercises.turtlesim_challenge.commands import WATCHDOG_TICKS
from grader.exercises.turtlesim_challenge.path import Path
from turtlesim_py.world.events import CmdVel
from turtlesim_py.world.turtle import TICK_S


def judge_rate(path: Path, tolerances: Tolerances) -> Finding:
    """Whether the commands came regularly, until the turtle drove no more."""
    ticks = np.array([c.tick for c in path.calls(CmdVel) if c.tick <= path.stop_tick + 1])
    if len(ticks) < 3:
        return Finding(0, f"Fewer than three commands ({len(ticks)}) have no rate.", "Use a timer.")
    gaps = np.diff(ticks)
    if gaps.max() > WATCHDOG_TICKS:
        row = int(np.argmax(gaps > WATCHDOG_TICKS))
        return Finding(
            0,
            f"No command came for {gaps[row] * TICK_S:.2f} s, and the turtle paused on its way: "
            "a command moves it for one second only.",
            "Publish at a fixed rate, faster than once a second.",
            (path.at(int(ticks[row]) + WATCHDOG_TICKS, "it stands still here"),),
        )
    median = float(np.median(gaps))
    if not median:
        return Finding(
            0,
            f"{len(ticks)} commands came in {(ticks[-1] - ticks[0]) * TICK_S:.1f} s, several in "
            "each step of the simulator: nothing makes your node wait between them.",
            "A timer keeps the rate fixed.",
            (path.at(int(ticks[0]), "here it begins to publish"),),
        )
    allowed = max(tolerances["rate_deviation"] * median, 1.5)
    regular = float(np.mean(np.abs(gaps - median) <= allowed))
    if regular < tolerances["rate_share"]:
        return Finding(
            0,
            f"The time between commands varies: usually it is {median * TICK_S:.2f} s, but only "
            f"{_percent(regular)} of the intervals are near that; "
            f"{_percent(tolerances['rate_share'])} are asked for.",
            "A timer keeps the rate fixed, as long as no callback takes long.",
        )
    text = f"A command every {median * TICK_S:.2f} s."
    return by_what_is_shown(path, tolerances, text)


def by_what_is_shown(path: Path, tolerances: Tolerances, text: str) -> Finding:
    """All of the points, or, for a path with few turns, a part of them."""
    share = shape.shown(path, tolerances)
    if share >= 1:
        return Finding(1, text)
    wanted = f"{tolerances['turns']:g} turns"
    rest = f"that is worth {_percent(share)} of the points" if share else "that tells nothing yet"
    return Finding(
        share,
        f"{text} But the path has fewer than the {wanted} that are asked for: {rest}.",
        "Look at the path first: this counts in full when all of it is driven.",
    )


def _percent(share: float) -> str:
    return f"{int(100 * share + 1e-9)} %"
