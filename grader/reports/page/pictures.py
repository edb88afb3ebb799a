"""Pictures inside a document: PNG as data URI, small enough for the systems that accept them.

Evidence is shown in them as numbered pins, placed so that no pin hides another.
"""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass

from PIL import Image, UnidentifiedImageError

from grader.reports.report import Point, Report

#: A larger picture is reduced to 256 colours. Only noise is larger: a spiral has some 20 kB.
_LIMIT_BYTES = 150_000


def canvas_uri(report: Report) -> str:
    """Return the final window of the nominal run; '' where there is no picture."""
    path = report.artifacts.canvas_file
    if path is not None:
        try:
            with Image.open(path, formats=["PNG"]) as image:
                if max(image.size) <= report.subject.plane.size_px:
                    # encoded again, without anything else in the file
                    return _uri(_png(image.convert("RGB")))
        except (OSError, UnidentifiedImageError):
            pass  # a damaged picture; the recording may have a good one
    return recorded_uri(report, 0)


def recorded_uri(report: Report, run: int) -> str:
    """Return the final window of a run's recording; '' without one, or without a picture."""
    recording = report.recordings.get(run)
    return _uri(recording.canvas) if recording is not None and recording.canvas else ""


def _uri(data: bytes) -> str:
    if len(data) > _LIMIT_BYTES:
        with Image.open(io.BytesIO(data)) as image:
            data = _png(image.quantize(256), optimize=True)
    return f"data:image/png;base64,{base64.b64encode(data).decode()}"


def _png(image: Image.Image, optimize: bool = False) -> bytes:
    out = io.BytesIO()
    image.save(out, format="PNG", optimize=optimize)
    return out.getvalue()


# Pins ---------------------------------------------------------------------------------------------

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
    """Place the pins of one run, those of failed checks first."""
    plane = report.subject.plane
    places = {
        p.number: _inside(*plane.to_px(*p.evidence.place), plane.size_px)
        for p in report.points
        if p.evidence.run == run and p.evidence.place and all(map(math.isfinite, p.evidence.place))
    }
    shown = [p for p in report.points if p.number in places]
    status = {p.number: report.verdicts[p.verdict].status for p in shown}
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
    """Return the nearest place for a head in the picture that covers nothing, or the best."""
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
    """Return the angle of 0, 1 step left, 1 step right, 2 steps left, ..."""
    steps = (direction + 1) // 2 * (1 if direction % 2 else -1)
    return 2 * math.pi / _DIRECTIONS * steps
