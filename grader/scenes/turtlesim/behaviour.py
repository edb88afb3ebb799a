"""What a submission asked turtlesim for and where turtle1 went; equal for two that did the same.

A velocity command counts by what the node takes from it: ahead, sideways, turning.
"""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from grader.scenes.scene import Behaviour, Command
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from turtlesim_py.world.events import CmdVel, Event


def behaviour(trace: TurtleTrace) -> Behaviour:
    """Every input to the arena, and turtle1's way up to where it was nowhere."""
    way = trace.trajectory()
    points = np.column_stack((way.x, way.y))
    lost = np.flatnonzero(~np.isfinite(points).all(axis=1))
    path = points[: int(lost[0])] if len(lost) else points
    return Behaviour(tuple(map(_command, trace.events)), path)


def _command(event: Event) -> Command:
    turtle = getattr(event, "turtle", FIRST_TURTLE)
    name = event.op if turtle == FIRST_TURTLE else f"{event.op} of another"
    return Command(event.tick, name, _values(event))


def _values(event: Event) -> tuple[float, ...]:
    if isinstance(event, CmdVel):
        return (event.linear[0], event.linear[1], event.angular[2])
    every = (getattr(event, field.name) for field in fields(event) if field.name != "tick")
    return tuple(float(value) for value in every if isinstance(value, int | float))
