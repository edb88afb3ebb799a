"""What the picture shows in each quarter of the window."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from grader.exercises.turtlesim_challenge.path import Path
from grader.exercises.turtlesim_challenge.pens import Color, pens_by_tick
from grader.recording.recording import Recording
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from turtlesim_py.world.arena import DEFAULT_BACKGROUND
from turtlesim_py.world.canvas import Canvas
from turtlesim_py.world.events import Clear, SetParameter
from turtlesim_py.world.turtle import METER_PX, SIZE_M

#: A band around the dividing lines in which colours may mix [px]: a late answer and a pen's width.
BAND_PX = 20
#: A quarter with less ink than this shows no spiral [px].
LEAST_PIXELS = 100

Pixels = npt.NDArray[np.uint8]


@dataclass(frozen=True)
class Quarter:
    """The ink of a quarter: how many pixels, the main colour, and its share of them."""

    pixels: int
    color: tuple[int, ...]
    share: float


def own_drawing(recording: Recording) -> Pixels:
    """The canvas, (500, 500, 4); without what turtle1 did not draw by driving, if there is such.

    Other turtles, teleports and a wiped canvas leave a picture that is not the path's. Then the
    path is drawn again, from the recorded poses.
    """
    path = Path(recording)
    trace = path.trace
    wiped = any(isinstance(event, Clear) for event in trace.events)
    if not path.foreign and not wiped and set(trace.trajectories) == {FIRST_TURTLE}:
        return trace.canvas
    canvas = Canvas()
    pens = pens_by_tick(recording)
    x, y = path.x * METER_PX, (SIZE_M - path.y) * METER_PX
    for row in range(1, len(path)):
        pen = pens[int(path.ticks[row])]
        if pen is None:
            continue
        canvas.draw_line(float(x[row]), float(y[row]), float(x[row - 1]), float(y[row - 1]), pen)
    return canvas.rgba()


def background(recording: Recording) -> Color:
    """The colour of the window at the end: what is drawn in it cannot be seen."""
    trace = TurtleTrace.of(recording.trace)
    colors = dict(zip("rgb", DEFAULT_BACKGROUND, strict=True))
    for event in trace.of_kind(SetParameter):
        if event.name.startswith("background_") and isinstance(event.value, int):
            colors[event.name.removeprefix("background_")] = event.value
    return colors["r"], colors["g"], colors["b"]


def quarters(canvas: Pixels, background: Color) -> dict[int, Quarter]:
    """Look at the four quarters of a canvas (height, width, 4); quadrant -> ink that shows."""
    height, width = canvas.shape[:2]
    top, bottom = slice(0, height // 2 - BAND_PX), slice(height // 2 + BAND_PX, height)
    left, right = slice(0, width // 2 - BAND_PX), slice(width // 2 + BAND_PX, width)
    parts = {1: (top, right), 2: (top, left), 3: (bottom, left), 4: (bottom, right)}
    return {
        quadrant: _look(canvas[rows, columns], background)
        for quadrant, (rows, columns) in parts.items()
    }


def _look(part: Pixels, background: Color) -> Quarter:
    shows = (part[..., 3] > 0) & (part[..., :3] != np.array(background)).any(axis=-1)
    ink = part[shows][:, :3]
    if not len(ink):
        return Quarter(0, (), 0.0)
    colors, counts = np.unique(ink, axis=0, return_counts=True)
    main = int(np.argmax(counts))
    return Quarter(len(ink), tuple(int(v) for v in colors[main]), float(counts[main]) / len(ink))
