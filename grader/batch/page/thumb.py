"""A run as a class page shows it: the picture at the end and the way that led there, both small.

    thumb.json      {"picture": "data:image/png;base64,...", "path": [[x, y, ...]], "schema": ...}

Reading a recording takes a second's part, and a class has hundreds: so it is made once, when a
student's folder is. The same recording always makes the same bytes.
"""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final, Literal, Self

import numpy as np
from PIL import Image

from grader import strict_json
from grader.recording.recording import Recording, Recordings
from grader.recording.subject import load_subject
from grader.recording.view import Floats
from grader.reports.page.html import draw
from grader.result import json_file

THUMB = "thumb.json"
SCHEMA: Final = "turtlesim-grader/thumb/v1"
#: The edge of the picture [px], and what it may weigh [bytes].
EDGE_PX, PICTURE_BYTES = 112, 4200
_COLOURS = (32, 16, 8, 4, 2)
#: The unit of a path: the picture's edge has so many.
UNITS = 1000
#: How far a path may be off [units], the first that leaves few enough points.
_TOLERANCES = (1.0, 1.5, 2.0, 3.0, 6.0, 12.0, 25.0, 50.0)
_MOST_POINTS, _MOST_PIECES = 300, 20
_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_PREFIX = "data:image/png;base64,"
#: No file of ours is longer [bytes].
_LIMIT_BYTES = 40_000

Piece = tuple[int, ...]
#: A line with more points is thinned out evenly first: simplifying can take time with their square.
_MOST_TO_SIMPLIFY = 2000


def _is_png(value: str) -> str:
    if not value.startswith(_PREFIX):
        raise ValueError("expected the address of a PNG")
    data = base64.b64decode(value.removeprefix(_PREFIX), validate=True)
    if not data.startswith(_SIGNATURE) or len(data) > 2 * PICTURE_BYTES:
        raise ValueError("expected a small PNG")
    return value


def _is_piece(numbers: Piece) -> Piece:
    if len(numbers) < 4 or len(numbers) % 2 or not all(0 <= each <= UNITS for each in numbers):
        raise ValueError(f"expected points from 0 to {UNITS}, two at least")
    return numbers


@dataclass(frozen=True)
class Thumb:
    """What is read back.

    Attributes:
        picture: as data URI.
        path: where what is driven went, in pieces: x0, y0, x1, y1, ... [`UNITS`, y down].
    """

    picture: Annotated[str, _is_png]
    path: tuple[Annotated[Piece, _is_piece], ...]
    schema: Literal["turtlesim-grader/thumb/v1"] = SCHEMA

    @classmethod
    def read(cls, folder: Path) -> Self | None:
        """What lies in the folder of a hand-in; None where nothing does that can be shown."""
        return json_file.kept(cls, folder / THUMB, _LIMIT_BYTES)

    def svg(self) -> str:
        """The path as the `d` of an SVG path: from each point the step to the next."""
        parts = []
        for piece in self.path:
            points = np.array(piece).reshape(-1, 2)
            steps = " ".join(f"{x} {y}" for x, y in np.diff(points, axis=0).tolist())
            parts.append(f"M{points[0][0]} {points[0][1]}l{steps.replace(' -', '-')}")
        return "".join(parts)


def thumb(recordings: Recordings) -> bytes:
    """The file's content: of the nominal run."""
    return strict_json.line(Thumb(_picture(recordings.nominal), _path(recordings.nominal)))


def _picture(recording: Recording) -> str:
    """The picture at the end with as many colours as there is room for; '' where there is none."""
    made = recording.pictures
    pixels = made.others.get("plan", made.window)  # the path is drawn over it
    if pixels is None:
        return ""
    whole = Image.fromarray(pixels).convert("RGB")
    small = whole.resize((EDGE_PX, EDGE_PX), Image.Resampling.LANCZOS)
    for colours in _COLOURS:
        file = io.BytesIO()
        # MEDIANCUT needs no library that a Pillow may lack
        reduced = small.quantize(colours, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
        reduced.save(file, format="PNG", optimize=True)
        if file.tell() <= PICTURE_BYTES:
            break
    return f"{_PREFIX}{base64.b64encode(file.getvalue()).decode()}"


def _path(recording: Recording) -> tuple[Piece, ...]:
    animation = draw(recording).animation  # the page of the student has drawn it already
    if animation is None or not animation.tracks:
        return ()
    scale = UNITS / load_subject(recording.scene).plane.size_px
    track = animation.tracks[0]
    whole = pieces(track.x * scale, track.y * scale)[:_MOST_PIECES]
    return tuple(_whole_numbers(piece) for piece in _few(whole))


def _few(whole: list[Floats]) -> list[Floats]:
    """The pieces with no more points than there is room for."""
    for tolerance in _TOLERANCES:
        shorter = [simplified(piece, tolerance) for piece in whole]
        if sum(map(len, shorter)) <= _MOST_POINTS:
            return shorter
    step = -(-sum(map(len, shorter)) // _MOST_POINTS)
    return [np.vstack([piece[:-1:step], piece[-1:]]) for piece in shorter]


def _whole_numbers(piece: Floats) -> Piece:
    return tuple(np.clip(np.rint(piece), 0, UNITS).astype(int).ravel().tolist())


def pieces(x: Floats, y: Floats) -> list[Floats]:
    """A line cut where a point is not finite; each piece (n, 2), two points at least."""
    points = np.column_stack([x, y])
    finite = np.isfinite(points).all(axis=1)
    cuts = np.flatnonzero(np.diff(finite.astype(np.int8))) + 1
    return [part for part in np.split(points, cuts) if len(part) > 1 and np.isfinite(part[0]).all()]


def simplified(points: Floats, tolerance: float) -> Floats:
    """Those of the points (n, 2) without which the line would be off by more than the tolerance.

    The way of Ramer (1972) and of Douglas and Peucker (1973).
    """
    step = max(1, -(-len(points) // _MOST_TO_SIMPLIFY))
    points = np.concatenate([points[:-1:step], points[-1:]])
    kept = np.zeros(len(points), dtype=bool)
    kept[[0, -1]] = True
    open_ended = [(0, len(points) - 1)]
    while open_ended:
        first, last = open_ended.pop()
        if last - first < 2:
            continue
        off = _distances(points[first + 1 : last], points[first], points[last])
        farthest = int(np.argmax(off))
        if off[farthest] > tolerance:
            middle = first + 1 + farthest
            kept[middle] = True
            open_ended += [(first, middle), (middle, last)]
    return points[kept]


def _distances(points: Floats, start: Floats, end: Floats) -> Floats:
    """How far the points are from the straight line between two others."""
    along = end - start
    squared = float(along @ along)
    at = np.clip((points - start) @ along / squared, 0, 1) if squared else np.zeros(len(points))
    off = points - start - np.outer(at, along)
    return np.asarray(np.sqrt((off**2).sum(axis=1)))
