"""What the reader of any result should know: what was done to the arena other than by driving."""

from __future__ import annotations

from collections.abc import Sequence

from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from turtlesim_py.ros.interfaces import NEWER, OLDER
from turtlesim_py.world.events import (
    Clear,
    Event,
    Kill,
    Reset,
    SetPen,
    Spawn,
    TeleportAbsolute,
    TeleportRelative,
)
from turtlesim_py.world.turtle import TICK_S

#: Calls that change the arena other than by driving, and what they do.
_INTERVENTIONS: dict[type[Event], str] = {
    TeleportAbsolute: "it moves a turtle without driving",
    TeleportRelative: "it moves a turtle without driving",
    Spawn: "it adds a turtle",
    Kill: "it removes a turtle",
    Reset: "it starts the arena anew",
    Clear: "it wipes the drawing",
}
_POSE = f"/{FIRST_TURTLE}/pose"


def _draws_with_0(event: SetPen) -> bool:
    return event.width == 0 and not event.off


def remarks(trace: TurtleTrace, published: Sequence[str], interfaces: str = OLDER) -> list[str]:
    """One sentence a thing.

    Args:
        published: the topics that the submission published on.
        interfaces: the package whose messages it was given.
    """
    found = []
    if interfaces == NEWER:
        found.append(
            f"The node was run with the messages of {NEWER}: ROS 2 has them from Kilted on, "
            f"in Jazzy they are those of {OLDER}."
        )
    for kind, effect in _INTERVENTIONS.items():
        calls = [event for event in trace.events if isinstance(event, kind)]
        if calls:
            first_s = calls[0].tick * TICK_S
            times = "once" if len(calls) == 1 else f"{len(calls)} times"
            found.append(f"The node called {kind.op} {times}, first at {first_s:.2f} s: {effect}.")
    thin = [event for event in trace.events if isinstance(event, SetPen) and _draws_with_0(event)]
    if thin:
        found.append(
            f"The pen's width is 0, first at {thin[0].tick * TICK_S:.2f} s: that draws like width "
            "1; what lifts the pen is off = 1."
        )
    if _POSE in published:
        found.append(
            f"The node published on {_POSE} itself. Judged is where the turtle really was."
        )
    return found
