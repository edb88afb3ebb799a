"""Which colour the pen had when, and which colour belongs to which quadrant."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from grader.exercise.check import Tolerances
from grader.exercises.turtlesim_challenge.path import Entry, Path
from grader.recording.recording import Recording
from grader.scenes.turtlesim.trace import FIRST_TURTLE, TurtleTrace
from turtlesim_py.world.canvas import Pen
from turtlesim_py.world.events import CmdVel, Kill, Reset, SetPen
from turtlesim_py.world.turtle import TICK_S

Color = tuple[int, int, int]


@dataclass(frozen=True)
class Coloring:
    """How the entries of one run were coloured.

    Attributes:
        judged: the entries that left time for an answer.
        bad: those of them after which the pen did not take the quadrant's colour in time.
        own: quadrant -> the colour that it ended with most often; None: with the pen up.
    """

    judged: list[Entry]
    bad: list[Entry]
    own: dict[int, Color | None]

    @property
    def tells(self) -> bool:
        """Whether the run went through enough quadrants to say anything."""
        return len(self.own) > 1

    @property
    def share(self) -> float:
        """The part of the entries that are right, less if quadrants share a colour."""
        if not self.tells:
            return 0.0
        return (1 - len(self.bad) / len(self.judged)) * self.different / len(self.own)

    @property
    def different(self) -> int:
        """How many colours the quadrants have."""
        return len(set(self.own.values()) - {None})


def coloring(path: Path, tolerances: Tolerances) -> Coloring:
    """Judge the colours of one run's entries.

    An entry has until `late_s` after it, or half of a usual stay in a quadrant where stays are
    shorter. Entries with a shorter stay than that, or after the last command, are not judged.
    """
    entries = path.entries(tolerances["band_m"])
    pens = pens_by_tick(path.recording)
    colors = [None if pen is None else (pen.r, pen.g, pen.b) for pen in pens]
    commands = path.calls(CmdVel)
    end = min(path.stop_tick, commands[-1].tick) if commands else 0
    if path.wall is not None:
        end = min(end, int(path.ticks[path.wall]))
    stays = [entry.last_tick - entry.tick + 1 for entry in entries]
    usual = float(np.median(stays)) if stays else 0.0
    patience = max(1, round(min(tolerances["late_s"] / TICK_S, usual / 2)))
    judged = [e for e in entries if e.tick + patience <= min(e.last_tick, end)]
    own = _own_colors(judged, colors)
    bad = [
        e
        for e in judged
        if own[e.quadrant] is None
        or colors[e.settled(patience)] != own[e.quadrant]
        or not _draws(colors[e.settled(patience) : e.last_tick + 1])
    ]
    return Coloring(judged, bad, own)


def pens_by_tick(recording: Recording) -> list[Pen | None]:
    """The pen in each tick, None where it is up; index 0 is before the first tick."""
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


def _own_colors(entries: list[Entry], colors: list[Color | None]) -> dict[int, Color | None]:
    counts: dict[int, Counter[Color | None]] = {}
    for entry in entries:
        counts.setdefault(entry.quadrant, Counter())[colors[entry.last_tick]] += 1
    return {quadrant: count.most_common(1)[0][0] for quadrant, count in counts.items()}
