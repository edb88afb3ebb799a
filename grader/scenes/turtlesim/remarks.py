"""Remarks for every result: how the node changed the arena other than by driving."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from grader.text.message import Message, msg, msg_many
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

#: Call that changes the arena other than by driving -> its effect.
_INTERVENTIONS: dict[type[Event], Message] = {
    TeleportAbsolute: msg("it moves a turtle without driving"),
    TeleportRelative: msg("it moves a turtle without driving"),
    Spawn: msg("it adds a turtle"),
    Kill: msg("it removes a turtle"),
    Reset: msg("it starts the arena anew"),
    Clear: msg("it wipes the drawing"),
}
_POSE = f"/{FIRST_TURTLE}/pose"


def remarks(
    trace: TurtleTrace, published: Sequence[str], interfaces: str = OLDER
) -> Iterator[Message]:
    """Yield the remarks, one sentence each.

    Args:
        published: the topics that the submission published on.
        interfaces: the package of turtlesim's messages in the run.
    """
    if interfaces == NEWER:
        yield msg(
            "The node was run with the messages of {newer}: ROS 2 has them from Kilted on, "
            "in Jazzy they are those of {older}.",
            newer=NEWER,
            older=OLDER,
        )
    for kind, effect in _INTERVENTIONS.items():
        calls = [event for event in trace.events if isinstance(event, kind)]
        if calls:
            yield msg_many(
                "The node called {call} once, first at {first_s:.2f} s: {effect}.",
                "The node called {call} {n} times, first at {first_s:.2f} s: {effect}.",
                len(calls),
                call=kind.op,
                first_s=calls[0].tick * TICK_S,
                effect=effect,
            )
    thin = [e for e in trace.events if isinstance(e, SetPen) and e.width == 0 and not e.off]
    if thin:
        yield msg(
            "The pen's width is 0, first at {first_s:.2f} s: that draws like width "
            "1; what lifts the pen is off = 1.",
            first_s=thin[0].tick * TICK_S,
        )
    if _POSE in published:
        yield msg(
            "The node published on {topic} itself. Judged is where the turtle really was.",
            topic=_POSE,
        )
