"""A run as a class page shows it: the picture at the end and the way that led there, both small.

    thumb.json      {"schema": ..., "picture": "data:image/png;base64,...", "path": [[x, y, ...]]}

Reading a recording takes a second's part, and a class has hundreds: so it is made once, when a
student's folder is. The same recording always makes the same bytes.
"""

from __future__ import annotations

import base64
import binascii
import io
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np
from PIL import Image

from grader import strict_json
from grader.batch.page.simplify import pieces, simplified
from grader.files import read_own
from grader.recording.recording import Recording, Recordings
from grader.reports.page.html import draw
from grader.scenes import load_scene
from grader.scenes.view import Floats

THUMB = "thumb.json"
SCHEMA = "turtlesim-grader/thumb/v1"
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


@dataclass(frozen=True)
class Thumb:
    """What is read back.

    Attributes:
        picture: as data URI.
        path: where what is driven went, in pieces: x0, y0, x1, y1, ... [`UNITS`, y down].
    """

    picture: str
    path: tuple[Piece, ...]

    @classmethod
    def read(cls, folder: Path) -> Self | None:
        """What lies in the folder of a hand-in; None where nothing does that can be shown."""
        try:
            data = read_own(folder / THUMB, _LIMIT_BYTES)
            return cls._from_json(strict_json.loads(data.decode("utf-8")))
        except (OSError, ValueError, RecursionError):
            return None

    @classmethod
    def _from_json(cls, data: Any) -> Self:
        if not isinstance(data, dict) or data.get("schema") != SCHEMA:
            raise ValueError(f"expected the schema {SCHEMA}")
        picture: Any = data.get("picture")
        path: Any = data.get("path")
        if not _is_picture(picture) or not _is_path(path):
            raise ValueError("expected a PNG and a path")
        return cls(picture, tuple(tuple(piece) for piece in path))

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
    data = {
        "schema": SCHEMA,
        "picture": _picture(recordings.nominal),
        "path": _path(recordings.nominal),
    }
    return f"{json.dumps(data, separators=(',', ':'))}\n".encode()


def _picture(recording: Recording) -> str:
    """The picture at the end with as many colours as there is room for."""
    made = recording.pictures
    pixels = made.others.get("plan", made.window)  # the path is drawn over it
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


def _path(recording: Recording) -> list[list[int]]:
    film = draw(recording).film  # the page of the student has drawn it already
    if film is None or not film.tracks:
        return []
    scale = UNITS / load_scene(recording.scene).plane.size_px
    track = film.tracks[0]
    whole = pieces(track.x * scale, track.y * scale)[:_MOST_PIECES]
    return [_whole_numbers(piece) for piece in _few(whole)]


def _few(whole: list[Floats]) -> list[Floats]:
    """The pieces with no more points than there is room for."""
    for tolerance in _TOLERANCES:
        shorter = [simplified(piece, tolerance) for piece in whole]
        if sum(map(len, shorter)) <= _MOST_POINTS:
            return shorter
    step = -(-sum(map(len, shorter)) // _MOST_POINTS)
    return [np.vstack([piece[:-1:step], piece[-1:]]) for piece in shorter]


def _whole_numbers(piece: Floats) -> list[int]:
    return np.clip(np.rint(piece), 0, UNITS).astype(int).ravel().tolist()


def _is_picture(value: object) -> bool:
    if not isinstance(value, str) or not value.startswith(_PREFIX):
        return False
    try:
        data = base64.b64decode(value.removeprefix(_PREFIX), validate=True)
    except binascii.Error:
        return False
    return data.startswith(_SIGNATURE) and len(data) <= 2 * PICTURE_BYTES


def _is_path(value: object) -> bool:
    return isinstance(value, list) and all(
        isinstance(piece, list)
        and len(piece) >= 4
        and len(piece) % 2 == 0
        and all(type(number) is int and 0 <= number <= UNITS for number in piece)
        for piece in value
    )
