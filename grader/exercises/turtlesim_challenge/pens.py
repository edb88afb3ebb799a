"""Which colour the pen had when, and which colour belongs to which quadrant."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np

from grader.exercise.check import Tolerances
from grader.exercises.turtlesim_challenge.path import Entry, Path
from grader.recording.recording import Recording
from grader.scenes.turtlesim.trace import TurtleTrace
from turtlesim_py.world.canvas import Pen
from turtlesim_py.world.events import CmdVel, SetPen
from turtlesim_py.world.turtle import TICK_S

Color = tuple[int, int, int]


@dataclass(frozen=True)
class Coloring:
    """How the entries of one run were coloured.

    Attributes:
        judged: the entries that left time for an answer.
        bad: those of them after which the pen did not take the quadrant's colour in time.
        own: quadrant -> the colour that it ended with most often.
    """

    judged: list[Entry]
    bad: list[Entry]
    own: dict[int, Color]

    @property
    def tells(self) -> bool:
        """Whether the run went through enough quadrants to say anything."""
        return len(self.own) > 1

    @property
    def share(self) -> float:
        """The part of the entries that are right, less if quadrants share a colour."""
        if not self.tells:
            return 0.0
        different = len(set(self.own.values())) / len(self.own)
        return (1 - len(self.bad) / len(self.judged)) * different


def coloring(path: Path, tolerances: Tolerances) -> Coloring:
    """Judge the colours of one run's entries.

    An entry has until `late_s` after it, or half of a usual stay in a quadrant where stays are
    shorter. Entries with a shorter stay than that, or after the last command, are not judged.
    """
    entries = path.entries(tolerances["band_m"])
    colors = colors_by_tick(path.recording)
    commands = path.calls(CmdVel)
    end = min(path.stop_tick, commands[-1].tick) if commands else 0
    if path.wall is not None:
        end = min(end, int(path.ticks[path.wall]))
    stays = [entry.last_tick - entry.tick + 1 for entry in entries]
    usual = float(np.median(stays)) if stays else 0.0
    patience = max(1, round(min(tolerances["late_s"] / TICK_S, usual / 2)))
    judged = [e for e in entries if e.tick + patience <= min(e.last_tick, end)]
    own = _own_colors(judged, colors)
    bad = [e for e in judged if colors[e.settled(patience)] != own[e.quadrant]]
    return Coloring(judged, bad, own)


def colors_by_tick(recording: Recording) -> list[Color]:
    """The pen's colour in each tick; index 0 is before the first tick."""
    color = (Pen().r, Pen().g, Pen().b)
    calls = [call for call in TurtleTrace.of(recording.trace).of_kind(SetPen) if not call.off]
    changes = {call.tick: (call.r, call.g, call.b) for call in calls}
    colors = []
    for tick in range(recording.run.ticks + 1):
        color = changes.get(tick, color)
        colors.append(color)
    return colors


def _own_colors(entries: list[Entry], colors: list[Color]) -> dict[int, Color]:
    counts: dict[int, Counter[Color]] = {}
    for entry in entries:
        counts.setdefault(entry.quadrant, Counter())[colors[entry.last_tick]] += 1
    return {quadrant: count.most_common(1)[0][0] for quadrant, count in counts.items()}
