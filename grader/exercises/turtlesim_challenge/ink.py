"""What the picture shows in each quarter of the window."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from grader.exercises.turtlesim_challenge.colours import Color, distances
from grader.exercises.turtlesim_challenge.path import Path
from grader.exercises.turtlesim_challenge.pens import pens_by_tick
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
    """The ink of a quarter: how many pixels, the main colour, and its share of them.

    What looks like the main colour counts as it; None where there is no ink.
    """

    pixels: int
    color: Color | None
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
    return _drawn_again(path, [])


def settled_drawing(recording: Recording, pauses: Iterable[tuple[int, int]]) -> Pixels:
    """The same without what was drawn in some ticks, each the first and the last of them."""
    return _drawn_again(Path(recording), pauses)


def _drawn_again(path: Path, pauses: Iterable[tuple[int, int]]) -> Pixels:
    canvas = Canvas()
    pens = pens_by_tick(path.recording)
    for first, last in pauses:
        pens[first : last + 1] = [None] * len(pens[first : last + 1])
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


def quarters(canvas: Pixels, background: Color, distance: float) -> dict[int, Quarter]:
    """Look at the four quarters of a canvas (height, width, 4); quadrant -> ink that shows.

    Args:
        distance: colours that are nearer in CIELAB look the same.
    """
    height, width = canvas.shape[:2]
    top, bottom = slice(0, height // 2 - BAND_PX), slice(height // 2 + BAND_PX, height)
    left, right = slice(0, width // 2 - BAND_PX), slice(width // 2 + BAND_PX, width)
    parts = {1: (top, right), 2: (top, left), 3: (bottom, left), 4: (bottom, right)}
    return {
        quadrant: _look(canvas[rows, columns], background, distance)
        for quadrant, (rows, columns) in parts.items()
    }


def _look(part: Pixels, background: Color, distance: float) -> Quarter:
    ink = part[part[..., 3] > 0][:, :3]
    colors, counts = np.unique(ink, axis=0, return_counts=True)
    shows = distances(colors, background) >= distance
    colors, counts = colors[shows], counts[shows]
    if not len(counts):
        return Quarter(0, None, 0.0)
    r, g, b = (int(channel) for channel in colors[int(np.argmax(counts))])
    total = int(counts.sum())
    main = int(counts[distances(colors, (r, g, b)) < distance].sum())
    return Quarter(total, (r, g, b), main / total)
