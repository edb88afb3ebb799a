"""Who says "tick": the wall clock, or the clock of a simulation on the topic /clock."""

from __future__ import annotations

import time
from collections.abc import Callable

from turtlesim_py.world.arena import TICK_NS

#: What the ROS clock has jumped ahead beyond this is not made up for [ns]: no command lives longer.
LONGEST_CATCH_UP_NS = 1_000_000_000


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


def follow_ros_clock(
    hear: Callable[[int], int], serve: Callable[[], bool], tick: Callable[[int], bool]
) -> None:
    """Call `tick` once for each 16 ms that the ROS clock has advanced, until it returns False.

    Every tick is made up for, because a simulation may tell the time more rarely or run faster
    than the wall clock. After a jump back, or far ahead, the ticks go on from there.

    Args:
        hear: waits so long [ns] for news of the clock and returns its time [ns], 0 while that is
            not known.
        serve: called every 16 ms of wall time that bring no tick, so that requests are answered
            while the clock rests. False ends it all.
        tick: gets the time of the tick [ns].
    """
    due = 0  # not known
    served = time.monotonic_ns()
    while True:
        now = hear(TICK_NS)
        if not due or not -TICK_NS <= now - due <= LONGEST_CATCH_UP_NS:
            due = now
        while now and due <= now:
            if not tick(due):
                return
            due += TICK_NS
            served = time.monotonic_ns()
        if time.monotonic_ns() - served >= TICK_NS:
            if not serve():
                return
            served = time.monotonic_ns()
