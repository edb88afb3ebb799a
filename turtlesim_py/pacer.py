"""Who says "tick": the wall clock."""

from __future__ import annotations

import time
from collections.abc import Callable

from turtlesim_py.world.arena import TICK_NS


def follow_wall_clock(tick: Callable[[], bool]) -> None:
    """Call `tick` every 16 ms until it returns False.

    A tick that comes late is not made up for: like the original, the turtles are then simply
    slower. The grid of ticks stays where it is, so that small delays do not add up.
    """
    due = time.monotonic_ns()
    while tick():
        due += TICK_NS
        late = time.monotonic_ns() - due
        if late < 0:
            time.sleep(-late / 1e9)
        else:
            due += late // TICK_NS * TICK_NS
