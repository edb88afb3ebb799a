"""Finds the pen's colour in each tick, and the colour of each quadrant."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np

from grader.exercise.check import Tolerances
from grader.exercises.turtlesim_challenge.colours import Color, alike, groups
from grader.exercises.turtlesim_challenge.path import QUADRANTS, Path, Visit
from grader.recording.recording import Recording
from grader.scenes.turtlesim.driving import as_commanded
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from grader.text.message import msg
from turtlesim_py.world.canvas import Pen
from turtlesim_py.world.events import CmdVel, Kill, Reset, SetPen
from turtlesim_py.world.turtle import TICK_S

#: At most this part of a stay in a quadrant may pass before the colour is there, however late an
#: exercise lets it come: what remains has to show it.
MOST_OF_A_STAY = 0.9


@dataclass(frozen=True)
class Coloring:
    """The colours of the entries of one run.

    Attributes:
        judged: the entries that left time for an answer.
        bad: those of them after which the pen did not take the quadrant's colour in time.
        by_quadrant: its colour: the one that is asked for, or else the one that it ended with most
            often; None: with the pen up.
        alike: the quadrants grouped by colours that look the same.
        colors: the pen's colour in each tick, None where it is up.
        waits: entry -> how many ticks the colour may take.
        wanted: how many quadrants with colours of their own make all of the points.
        least: fewer right entries than this part are chance.
    """

    judged: list[Visit]
    bad: list[Visit]
    by_quadrant: dict[int, Color | None]
    alike: list[list[int]]
    colors: list[Color | None]
    waits: dict[Visit, int]
    wanted: int
    least: float

    @property
    def is_conclusive(self) -> bool:
        """Whether the run went through enough quadrants to be judged."""
        return len(self.by_quadrant) > 1

    @property
    def share(self) -> float:
        """The part of the entries that are right, times the part of the colours; 0 by chance."""
        if not self.is_conclusive or self.right < self.least:
            return 0.0
        return self.right * self.different / max(self.wanted, len(self.by_quadrant))

    @property
    def right(self) -> float:
        """The part of the entries that are right."""
        return 1 - len(self.bad) / len(self.judged) if self.judged else 0.0

    @property
    def different(self) -> int:
        """The number of different colours of the quadrants."""
        return len(self.alike)


def coloring(
    path: Path,
    tolerances: Tolerances,
    wanted: int = 0,
    known: Mapping[int, Color | None] | None = None,
) -> Coloring:
    """Judge the colours of one run's entries.

    An entry has `late_s` for its colour, but no more than most of its stay. Entries with a stay
    that is shorter than both `late_s` and half of a usual stay, or after the last command, are not
    judged.

    Args:
        wanted: how many quadrants with colours of their own make all of the points; 0: those that
            were entered.
        known: the quadrants' colours, where another run has shown them.
    """
    entries = path.entries(tolerances["band_m"])
    pens = pens_by_tick(path.recording)
    colors = [None if pen is None else (pen.r, pen.g, pen.b) for pen in pens]
    commands = path.calls(CmdVel)
    end = min(path.stop_tick, commands[-1].tick) if commands else 0
    if path.wall is not None:
        end = min(end, int(path.ticks[path.wall]))
    stays = [entry.last_tick - entry.tick + 1 for entry in entries]
    late = tolerances["late_s"] / TICK_S
    least = max(1, round(min(late, float(np.median(stays)) / 2))) if stays else 1
    waits = {
        entry: max(least, round(min(late, MOST_OF_A_STAY * stay)))
        for entry, stay in zip(entries, stays, strict=True)
        if entry.tick + least <= min(entry.last_tick, end)
    }
    judged = [entry for entry in waits if entry.tick + waits[entry] <= end]
    near = tolerances["color_distance"]
    by_quadrant = _usual_colors(judged, colors)
    asked = {**(known or {}), **demanded(tolerances)}
    by_quadrant = {quadrant: asked.get(quadrant, color) for quadrant, color in by_quadrant.items()}
    bad = [
        e
        for e in judged
        if by_quadrant[e.quadrant] is None
        or not alike(colors[e.settled(waits[e])], by_quadrant[e.quadrant], near)
        or not _draws(colors[e.settled(waits[e]) : e.last_tick + 1])
    ]
    alike_ones, by_chance = groups(by_quadrant, near), tolerances["chance_share"]
    if judged:  # what shows a colour itself has it, and tells nothing
        shown = len(by_quadrant.keys() - asked.keys()) / len(judged)
        by_chance = shown + by_chance * (1 - shown)
    return Coloring(judged, bad, by_quadrant, alike_ones, colors, waits, wanted, by_chance)


def go_by_commands(path: Path, found: Coloring, tolerances: Tolerances) -> bool:
    """Whether the colours fit as well where exactly obeyed commands would have taken the turtle."""
    start = path.recording.start
    if start is None or start.is_as_commanded or not 0 < found.right < 1:
        return False
    believed = replace(path.recording, trace=as_commanded(path.trace, start))
    return coloring(Path(believed), tolerances).right >= found.right


def demanded(tolerances: Tolerances) -> dict[int, Color]:
    """Return the colours that the exercise asks for, by quadrant; as a rule none."""
    asked = tolerances.get("colours") or {}
    return {int(quadrant): (c[0], c[1], c[2]) for quadrant, c in asked.items()}


def check_demanded(asked: Any) -> None:
    """Validate the colours that an exercise asks for."""
    if not isinstance(asked, dict):
        raise ValueError(msg("expected quadrants with colours, found {found}", found=repr(asked)))
    for quadrant, color in asked.items():
        if type(quadrant) is not int or not 1 <= quadrant <= QUADRANTS:
            raise ValueError(
                msg(
                    "expected quadrants from 1 to {most}, found {found}",
                    most=QUADRANTS,
                    found=repr(quadrant),
                )
            )
        is_color = isinstance(color, list) and len(color) == len("rgb")
        if not is_color or not all(type(c) is int and 0 <= c <= 255 for c in color):
            raise ValueError(
                msg(
                    "{quadrant}: expected [red, green, blue], each a whole number from 0 to 255, "
                    "found {found}",
                    quadrant=quadrant,
                    found=repr(color),
                )
            )
    for (one, color), (another, other) in combinations(asked.items(), 2):
        if color == other:
            raise ValueError(
                msg(
                    "{one} and {another} are the same; expected different colours",
                    one=one,
                    another=another,
                )
            )


def came_after(entry: Visit, coloring: Coloring, distance: float) -> int | None:
    """Return how many ticks after an entry the pen had the quadrant's colour; None: never."""
    color = coloring.by_quadrant[entry.quadrant]
    if color is None:
        return None
    for tick in range(entry.tick, entry.last_tick + 1):
        if alike(coloring.colors[tick], color, distance):
            return tick - entry.tick
    return None


def pens_by_tick(recording: Recording) -> list[Pen | None]:
    """Return the pen in each tick, None where it is up; index 0 is before the first tick."""
    pen, is_down = Pen(), True
    changes: dict[int, Pen | None] = {}
    for event in TurtleTrace.of(recording.trace).events:
        match event:
            case SetPen(turtle=turtle) if turtle == FIRST_TURTLE:
                is_down = not event.off
                if is_down:  # a pen that is lifted keeps its colour
                    pen = Pen(event.r, event.g, event.b, event.width)
            case Reset():
                pen, is_down = Pen(), True
            case Kill(name=name) if name == FIRST_TURTLE:  # the next one has a pen of its own
                pen, is_down = Pen(), True
            case _:
                continue
        changes[event.tick] = pen if is_down else None
    now: Pen | None = Pen()
    pens = []
    for tick in range(recording.run.ticks + 1):
        now = changes.get(tick, now)
        pens.append(now)
    return pens


def _draws(colors: list[Color | None]) -> bool:
    """Whether the pen is down most of the time."""
    return 2 * colors.count(None) < len(colors)


def _usual_colors(entries: list[Visit], colors: list[Color | None]) -> dict[int, Color | None]:
    counts: dict[int, Counter[Color | None]] = {}
    for entry in entries:
        counts.setdefault(entry.quadrant, Counter())[colors[entry.last_tick]] += 1
    return {quadrant: count.most_common(1)[0][0] for quadrant, count in counts.items()}
