"""Judges whether the picture shows four quarters in four colours."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from grader.exercise.check import Tolerances
from grader.exercise.verdict import Finding
from grader.exercises.turtlesim_challenge import colours, mistakes, pens, shape
from grader.exercises.turtlesim_challenge.colours import Color, distances
from grader.exercises.turtlesim_challenge.path import NAMES, QUADRANTS, ROMAN, Path
from grader.recording.recording import Recording
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from grader.text.message import Message, joined, msg
from turtlesim_py.world.arena import DEFAULT_BACKGROUND
from turtlesim_py.world.canvas import Canvas
from turtlesim_py.world.events import Clear, SetParameter, SetPen
from turtlesim_py.world.turtle import METER_PX, SIZE_M

#: A band around the dividing lines in which colours may mix [px]: a late answer and a pen's width.
BAND_PX = 20
#: A quarter with less ink than this shows no spiral [px].
LEAST_PIXELS = 100

Pixels = npt.NDArray[np.uint8]


def judge_picture(recording: Recording, tolerances: Tolerances) -> Finding:
    """Judge that all quarters have ink, each mainly in one colour, and these colours differ."""
    background, near = background_of(recording), tolerances["color_distance"]
    quarters = quarters_of(driven_drawing(recording), background, near)
    empty = [NAMES[q] for q, quarter in quarters.items() if quarter.pixels < LEAST_PIXELS]
    if empty:
        return Finding(
            0,
            msg(
                "There is next to nothing drawn in quadrant {quadrants}.",
                quadrants=joined(empty, ", "),
            ),
            _how_to_draw(recording, near),
        )
    mixed = _mixed(quarters, tolerances)
    if mixed:
        # A colour may come as late as pen_per_quadrant allows: what was drawn until then is no mix.
        settled = settled_drawing(recording, _pauses(recording, tolerances))
        for quadrant, quarter in quarters_of(settled, background, near).items():
            if quarter.pixels >= LEAST_PIXELS:
                quarters[quadrant] = quarter
        mixed = _mixed(quarters, tolerances)
    if mixed:
        shares = ", ".join(f"{ROMAN[q]} {int(100 * quarters[q].share)} %" for q in mixed)
        return Finding(
            0,
            msg(
                "Some quarters mix colours. The main colour should cover {own_ink:g} % or more of "
                "what is drawn there; it covers only: {shares}.",
                own_ink=100 * tolerances["own_ink"],
                shares=shares,
            ),
            msg("The colour should change where the turtle enters a quadrant."),
        )
    colors = {quadrant: quarter.color for quadrant, quarter in quarters.items()}
    groups = colours.groups(colors, near)
    if len(groups) < QUADRANTS:
        cause = mistakes.alike(groups, colors)
        hardly_driven = not shape.shown(Path(recording), tolerances)
        return Finding(0, cause.text, mistakes.SPIRAL_FIRST if hardly_driven else cause.help)
    total = sum(quarter.pixels for quarter in quarters.values())
    return Finding(1, msg("Four quarters, four colours, {total} painted pixels.", total=total))


def _mixed(quarters: dict[int, Quarter], tolerances: Tolerances) -> list[int]:
    return [q for q, quarter in quarters.items() if quarter.share < tolerances["own_ink"]]


def _pauses(recording: Recording, tolerances: Tolerances) -> list[tuple[int, int]]:
    """Return from and to which ticks the colour may still be that of the quadrant before."""
    path = Path(recording)
    entries = path.entries(tolerances["band_m"])
    waits = pens.coloring(path, tolerances).waits
    before = [0, *(entry.last_tick + 1 for entry in entries[:-1])]
    return [
        (first, entry.tick + waits[entry])
        for first, entry in zip(before, entries, strict=True)
        if entry in waits
    ]


def _how_to_draw(recording: Recording, near: float) -> Message:
    calls = TurtleTrace.of(recording.trace).of_kind(SetPen)
    if any(call.off for call in calls):
        return msg(
            "The pen is off: look at what your requests say of `off`; 0 is a pen that draws."
        )
    background = background_of(recording)
    if any(colours.alike((call.r, call.g, call.b), background, near) for call in calls):
        return msg("What is drawn in the colour of the background cannot be seen.")
    return msg("Draw on until the spiral fills the window.")


# What is drawn in each quarter of the window -----------------------------------------------------


@dataclass(frozen=True)
class Quarter:
    """The ink of a quarter: how many pixels, the main colour, and its share of them.

    What looks like the main colour counts as it; None where there is no ink.
    """

    pixels: int
    color: Color | None
    share: float


def driven_drawing(recording: Recording) -> Pixels:
    """Return the canvas, (500, 500, 4), without what turtle1 did not draw by driving.

    Other turtles, teleports and a wiped canvas leave a picture that is not the path's. Then the
    path is drawn again, from the recorded poses.
    """
    path = Path(recording)
    trace = path.trace
    wiped = any(isinstance(event, Clear) for event in trace.events)
    if not path.relocations and not wiped and set(trace.trajectories) == {FIRST_TURTLE}:
        return trace.canvas
    return _drawn_again(path, [])


def settled_drawing(recording: Recording, pauses: Iterable[tuple[int, int]]) -> Pixels:
    """Draw the path without some ranges of ticks, each given by its first and last."""
    return _drawn_again(Path(recording), pauses)


def _drawn_again(path: Path, pauses: Iterable[tuple[int, int]]) -> Pixels:
    canvas = Canvas()
    by_tick = pens.pens_by_tick(path.recording)
    for first, last in pauses:
        by_tick[first : last + 1] = [None] * len(by_tick[first : last + 1])
    x, y = path.x * METER_PX, (SIZE_M - path.y) * METER_PX
    for row in range(1, len(path)):
        pen = by_tick[int(path.ticks[row])]
        if pen is None:
            continue
        canvas.draw_line(float(x[row]), float(y[row]), float(x[row - 1]), float(y[row - 1]), pen)
    return canvas.rgba()


def background_of(recording: Recording) -> Color:
    """The colour of the window at the end: what is drawn in it cannot be seen."""
    trace = TurtleTrace.of(recording.trace)
    colors = dict(zip("rgb", DEFAULT_BACKGROUND, strict=True))
    for event in trace.of_kind(SetParameter):
        if event.name.startswith("background_") and isinstance(event.value, int):
            colors[event.name.removeprefix("background_")] = event.value
    return colors["r"], colors["g"], colors["b"]


def quarters_of(canvas: Pixels, background: Color, distance: float) -> dict[int, Quarter]:
    """Measure the four quarters of a canvas (height, width, 4): quadrant -> its visible ink.

    Args:
        distance: colours that are nearer in CIELAB look the same.
    """
    height, width = canvas.shape[:2]
    top, bottom = slice(0, height // 2 - BAND_PX), slice(height // 2 + BAND_PX, height)
    left, right = slice(0, width // 2 - BAND_PX), slice(width // 2 + BAND_PX, width)
    parts = {1: (top, right), 2: (top, left), 3: (bottom, left), 4: (bottom, right)}
    return {
        quadrant: _quarter(canvas[rows, columns], background, distance)
        for quadrant, (rows, columns) in parts.items()
    }


def _quarter(part: Pixels, background: Color, distance: float) -> Quarter:
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
