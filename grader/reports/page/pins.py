"""Evidence as numbered pins in a picture, placed so that no pin hides another."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from grader.reports.report import Point, Report

#: A pin's head [px], and how far it stands from the place that it points to.
RADIUS_PX = 11.0
_DISTANCES_PX = (26.0, 44.0, 62.0, 80.0)
_DIRECTIONS = 12


@dataclass(frozen=True)
class Pin:
    """A numbered head at (head_x, head_y) that points to (x, y), all [px, y down]."""

    point: Point
    status: str
    x: float
    y: float
    head_x: float
    head_y: float


def pins(report: Report, run: int) -> tuple[Pin, ...]:
    """The pins of one run: those of failed checks have the first choice of a place."""
    shown = [p for p in report.points if p.evidence.run == run and p.evidence.has_place]
    plane = report.scene.plane
    status = {p.number: report.verdicts[p.verdict].status for p in shown}
    places = {
        p.number: _inside(*plane.to_px(p.evidence.x, p.evidence.y), plane.size_px) for p in shown
    }
    placed: list[Pin] = []
    for point in sorted(shown, key=lambda p: status[p.number] == "passed"):
        x, y = places[point.number]
        head_x, head_y = _free_place(x, y, placed, list(places.values()), plane.size_px)
        placed.append(Pin(point, status[point.number], x, y, head_x, head_y))
    return tuple(sorted(placed, key=lambda pin: pin.point.number))


def _inside(x: float, y: float, size_px: int) -> tuple[float, float]:
    return min(max(x, 0.0), float(size_px)), min(max(y, 0.0), float(size_px))


def _free_place(
    x: float, y: float, others: Sequence[Pin], places: Sequence[tuple[float, float]], size_px: int
) -> tuple[float, float]:
    """The nearest place for a head that is in the picture and covers nothing; or the best."""
    best, most_room = (x, y), -math.inf
    for distance in _DISTANCES_PX:
        for direction in range(_DIRECTIONS):
            # First away from the middle: there the picture is emptiest.
            angle = math.atan2(y - size_px / 2, x - size_px / 2) + _turned(direction)
            head = (x + distance * math.cos(angle), y + distance * math.sin(angle))
            if not all(RADIUS_PX + 2 <= c <= size_px - RADIUS_PX - 2 for c in head):
                continue
            heads = [math.dist(head, (o.head_x, o.head_y)) - 2 * RADIUS_PX - 2 for o in others]
            spots = [math.dist(head, place) - RADIUS_PX - 4 for place in places]
            room = min([*heads, *spots], default=0.0)
            if room >= 0:
                return head
            if room > most_room:
                best, most_room = head, room
    return best


def _turned(direction: int) -> float:
    """0, 1 step left, 1 step right, 2 steps left, ..."""
    steps = (direction + 1) // 2 * (1 if direction % 2 else -1)
    return 2 * math.pi / _DIRECTIONS * steps
