"""The data of an animation: for every frame of a run, the painted pixels and the turtles.

A frame is the picture after a tick; frame 0 is that before the first. Columns are sent as bytes in
base64, little-endian, so that NaN, infinities and every last bit arrive.
"""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from turtlesim_py.world.canvas import Pen
from turtlesim_py.world.stroke import SIZE_PX, Span
from turtlesim_py.world.turtle import Pose

Color = tuple[int, int, int]
#: Centre on the canvas [px, y down] and heading [rad].
Place = tuple[float, float, float]
#: In place of a colour: all paint is wiped.
WIPED: Final = -1


@dataclass
class _TurtleFrames:
    """One turtle, frame by frame; there may be gaps."""

    stretches: list[list[int]] = field(default_factory=list)
    places: list[Place] = field(default_factory=list)
    poses: list[Pose] = field(default_factory=list)
    pens: list[list[int]] = field(default_factory=list)


class Animation:
    """Records the drawing events of a run, frame by frame, and writes them as JSON."""

    def __init__(self) -> None:
        self._parts: dict[str, _TurtleFrames] = {}
        self._backgrounds: list[list[Any]] = []
        self._colors: dict[Color, int] = {}
        self._ops: list[list[int]] = []
        self._runs: list[int] = []
        # the number of each pixel's colour, from 1; a run of pixels that changes none is left out
        self._paint: npt.NDArray[np.int32] = np.zeros((SIZE_PX, SIZE_PX), np.int32)

    def stroke(self, frame: int, color: Color, runs: Iterable[Span]) -> None:
        """Paint runs of pixels: row, first and last column."""
        number = self._colors.setdefault(color, len(self._colors))
        changed = 0
        for row, first, last in runs:
            pixels = self._paint[row, first : last + 1]
            if (pixels != number + 1).any():
                pixels[:] = number + 1
                self._runs += (row, first, last)
                changed += 1
        if self._ops and self._ops[-1][:2] == [frame, number]:
            self._ops[-1][2] += changed
        elif changed:
            self._ops.append([frame, number, changed])

    def wipe(self, frame: int) -> None:
        self._paint[:] = 0
        self._ops.append([frame, WIPED, 0])

    def background(self, frame: int, color: Sequence[int]) -> None:
        """Set the colour that shows where there is no paint."""
        if not self._backgrounds or self._backgrounds[-1][1] != list(color):
            self._backgrounds.append([frame, list(color)])

    def turtle(self, frame: int, name: str, place: Place, pose: Pose) -> None:
        """Place a turtle in this frame: centre [px, y down], heading [rad], and its pose."""
        part = self._parts.setdefault(name, _TurtleFrames())
        if part.stretches and part.stretches[-1][1] == frame - 1:
            part.stretches[-1][1] = frame
        else:
            part.stretches.append([frame, frame])
        part.places.append(place)
        part.poses.append(pose)

    def pen(self, frame: int, name: str, pen: Pen, is_on: bool) -> None:
        """Set the pen of a turtle that `turtle` has placed in this frame."""
        pens = self._parts[name].pens
        now = [pen.r, pen.g, pen.b, pen.width, int(not is_on)]
        if not pens or pens[-1][1:] != now:
            pens.append([frame, *now])

    def to_json(self, last: int) -> dict[str, Any]:
        """Return all frames up to `last`, as `page/animation.js` reads them."""
        return {
            "last": last,
            "colors": [list(color) for color in self._colors],
            "ops": [number for op in self._ops for number in op],
            "runs": _packed(self._runs, "<u2"),
            "backgrounds": self._backgrounds,
            "turtles": [
                {
                    "name": name,
                    "stretches": part.stretches,
                    "places": _packed(part.places, "<f8"),
                    "poses": _packed(part.poses, "<f4"),
                    "pens": part.pens,
                }
                # the later in the order of their names lie on top
                for name, part in sorted(self._parts.items())
            ],
        }


def _packed(numbers: Sequence[Any], kind: str) -> str:
    with np.errstate(over="ignore"):  # what is beyond a single is infinite there
        return base64.b64encode(np.array(numbers, dtype=kind).tobytes()).decode()
