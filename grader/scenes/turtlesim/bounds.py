"""Whether a trace that comes from outside can be one: what the recorder never writes, nobody reads.

A recording may come from anywhere. Poses and velocities can be any numbers, also none: a student's
node sends what it likes. Ticks, pens, names and pictures cannot.
"""

from __future__ import annotations

import numpy as np

from grader.scenes.turtlesim.trace import TurtleTrace
from turtlesim_py.world.canvas import SIZE_PX
from turtlesim_py.world.events import Cancel, Event, RotateAbsolute, SetParameter, SetPen
from turtlesim_py.world.trajectory import Trajectory


def check(trace: TurtleTrace) -> None:
    """Look at all of it.

    Raises:
        ValueError: something in it cannot have been recorded; the text says what.
    """
    for event in trace.events:
        _check_event(event, trace.ticks)
    for name, way in trace.trajectories.items():
        _check_way(name, way, trace.ticks)
    for log in trace.logs:
        _check_tick("a log line", log.tick, trace.ticks)
    for name, pixels, channels in (("path", trace.canvas, 4), ("window", trace.window, 3)):
        height, width = trace.canvas.shape[:2]
        right = (height, width, channels)
        if pixels.shape != right or pixels.dtype != np.uint8 or max(height, width) > SIZE_PX:
            raise ValueError(f"the picture {name} is {pixels.dtype} of the shape {pixels.shape}")


def _check_event(event: Event, ticks: int) -> None:
    _check_tick(event.op, event.tick, ticks)
    if isinstance(event, SetPen):
        for name in ("r", "g", "b", "width", "off"):
            if not 0 <= getattr(event, name) <= 255:
                raise ValueError(f"set_pen: {name} is {getattr(event, name)!r:.40}")
    if isinstance(event, SetParameter) and not isinstance(event.value, bool | int | float | str):
        raise ValueError(f"param: a value is a {type(event.value).__name__}")
    if isinstance(event, RotateAbsolute | Cancel) and not isinstance(event.id, str | int | float):
        raise ValueError(f"{event.op}: an id is a {type(event.id).__name__}")


def _check_tick(what: str, tick: int, ticks: int) -> None:
    # what comes after the last tick would have taken effect in the next one
    if not 0 <= tick <= ticks + 1:
        raise ValueError(f"{what} at tick {tick!r:.40} of {ticks}")


def _check_way(name: str, way: Trajectory, ticks: int) -> None:
    if not len(way):
        return
    if way.ticks[0] < 1 or way.ticks[-1] > ticks or (np.diff(way.ticks) <= 0).any():
        raise ValueError(f"the ticks of {name!r:.40} are not in order, or not of this run")
