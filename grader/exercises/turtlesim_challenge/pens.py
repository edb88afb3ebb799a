"""Which colour the pen had when, and which colour belongs to which quadrant."""

from __future__ import annotations

from collections import defaultdict
from itertools import pairwise
from typing import Any

from grader.exercises.turtlesim_challenge.path import Entry, Path
from grader.recording import Recording
from turtlesim_py.world.canvas import Pen

Color = tuple[int, int, int]


def colors_by_tick(recording: Recording) -> list[Color]:
    """The pen's colour in each tick; index 0 is before the first tick."""
    default = Pen()
    color = (default.r, default.g, default.b)
    changes = {
        c["tick"]: (c["r"], c["g"], c["b"]) for c in recording.calls("set_pen") if not c["off"]
    }
    colors = [color]
    for tick in range(1, recording.run.ticks + 1):
        color = changes.get(tick, color)
        colors.append(color)
    return colors


def own_colors(path: Path, entries: list[Entry], colors: list[Color]) -> dict[int, Color]:
    """The colour with which most of the way through each quadrant was drawn."""
    counts: dict[int, defaultdict[Color, float]] = {}
    for entry in entries:
        count = counts.setdefault(entry.quadrant, defaultdict(float))
        for tick in range(entry.tick, entry.last_tick + 1):
            count[colors[tick]] += float(path.speed[tick - 1])
    return {quadrant: max(count, key=count.__getitem__) for quadrant, count in counts.items()}


def in_time(entry: Entry, own: dict[int, Color], colors: list[Color], late_ticks: int) -> bool:
    """Whether the pen has the quadrant's colour soon after the entry."""
    deadline = min(entry.tick + late_ticks, entry.last_tick)
    return colors[deadline] == own.get(entry.quadrant)


def repeated(calls: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The calls that asked for what was already so."""
    keys = ("r", "g", "b", "width", "off")
    pairs = pairwise(calls)
    return [later for earlier, later in pairs if all(earlier[k] == later[k] for k in keys)]
