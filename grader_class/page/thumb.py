"""A run on the class page: a small picture of its end, and the driven path.

    thumb.json   {"picture": "data:image/png;base64,...", "words": "", "path": [[x, y, ...]], ...}

Reading a recording takes a fraction of a second, and a class has hundreds: so it is made once,
together with a student's folder. The same recording always gives the same bytes.
"""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final, Literal, Self

import numpy as np
from PIL import Image

from grader import Recording, Recordings
from grader.exercise import json_file
from grader.reports import draw
from grader.scenes import load_subject
from grader.scenes.view import Floats
from grader.system import strict_json
from grader.text import clip, translate

THUMB = "thumb.json"
SCHEMA: Final = "turtlesim-grader/thumb/v1"
#: The edge of the picture [px], and its largest size [bytes].
EDGE_PX, PICTURE_BYTES = 112, 4200
_COLOURS = (32, 16, 8, 4, 2)
#: The unit of a path: the picture's edge has so many.
UNITS = 1000
#: Tolerances of a path [units]; the first that leaves few enough points is used.
_TOLERANCES = (1.0, 1.5, 2.0, 3.0, 6.0, 12.0, 25.0, 50.0)
_MOST_POINTS, _MOST_PIECES = 300, 20
_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_PREFIX = "data:image/png;base64,"
_MOST_WORDS = 120
#: The largest valid file [bytes].
_LIMIT_BYTES = 40_000

Piece = tuple[int, ...]


def _is_png(value: str) -> str:
    if not value:
        return value
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
    """The content of thumb.json.

    Attributes:
        picture: as data URI; '' for none.
        words: what there is to see, where there is no picture.
        path: the driven path, in pieces: x0, y0, x1, y1, ... [`UNITS`, y down].
    """

    picture: Annotated[str, _is_png]
    words: str
    path: tuple[Annotated[Piece, _is_piece], ...]
    schema: Literal["turtlesim-grader/thumb/v1"] = SCHEMA

    @classmethod
    def read(cls, folder: Path) -> Self | None:
        """Read that of a hand-in's folder; None where there is no valid one, or nothing to see."""
        kept = json_file.kept(cls, folder / THUMB, _LIMIT_BYTES)
        return kept if kept is not None and (kept.picture or kept.words) else None

    def svg(self) -> str:
        """Return the path as the `d` of an SVG path, with relative steps."""
        parts = []
        for piece in self.path:
            points = np.array(piece).reshape(-1, 2)
            steps = " ".join(f"{x} {y}" for x, y in np.diff(points, axis=0).tolist())
            parts.append(f"M{points[0][0]} {points[0][1]}l{steps.replace(' -', '-')}")
        return "".join(parts)


def thumb(recordings: Recordings) -> bytes:
    """Return the file's content, of the nominal run."""
    run = recordings.nominal
    picture, solid = _picture(run), draw(run).solid
    words = clip(translate(solid.text), _MOST_WORDS) if solid and not picture else ""
    return strict_json.line(Thumb(picture, words, _path(run)))


def _picture(recording: Recording) -> str:
    """Return the last picture with as many colours as fit; '' where there is none."""
    pixels = recording.pictures.window  # the path is drawn over it
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
    rounded = (np.clip(np.rint(piece), 0, UNITS).astype(int) for piece in _few(whole))
    return tuple(tuple(piece.ravel().tolist()) for piece in rounded)


def _few(whole: list[Floats]) -> list[Floats]:
    """Simplify the pieces until they have few enough points."""
    for tolerance in _TOLERANCES:
        shorter = [simplified(piece, tolerance) for piece in whole]
        if sum(map(len, shorter)) <= _MOST_POINTS:
            return shorter
    step = -(-sum(map(len, shorter)) // _MOST_POINTS)
    return [np.vstack([piece[:-1:step], piece[-1:]]) for piece in shorter]


def pieces(x: Floats, y: Floats) -> list[Floats]:
    """Cut a line where a point is not finite; each piece (n, 2) has two points at least."""
    points = np.column_stack([x, y])
    finite = np.isfinite(points).all(axis=1)
    cuts = np.flatnonzero(np.diff(finite.astype(np.int8))) + 1
    return [part for part in np.split(points, cuts) if len(part) > 1 and np.isfinite(part[0]).all()]


def simplified(points: Floats, tolerance: float) -> Floats:
    """Return the points (n, 2) that keep the line within the tolerance.

    The algorithm of Ramer (1972) and of Douglas and Peucker (1973); it may be quadratic, but an
    animation has few samples.
    """
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
    """Return the distances of points from the line segment between two others."""
    along = end - start
    squared = float(along @ along)
    at = np.clip((points - start) @ along / squared, 0, 1) if squared else np.zeros(len(points))
    off = points - start - np.outer(at, along)
    return np.asarray(np.sqrt((off**2).sum(axis=1)))
