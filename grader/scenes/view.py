"""A trace as people look at it: pictures, tracks in a plane, curves over time, calls.

A scene makes these; a page draws them and knows nothing else of a scene.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Pixels = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Curve:
    """A quantity over time.

    Attributes:
        title, unit: what it shows.
        ticks, values: float64 (n,); not a number where it has no value.
    """

    title: str
    unit: str
    ticks: Floats
    values: Floats


@dataclass(frozen=True)
class Call:
    """Something that the submission asked for.

    Attributes:
        name: its kind.
        tick: when.
        color: "#rrggbb", where it names one.
        text: what exactly, colours in words too; '' where the name says all.
        where: the part of the picture in which it happened, in words; '' where it has no place.
    """

    name: str
    tick: int
    color: str = ""
    text: str = ""
    where: str = ""


@dataclass(frozen=True)
class PenChange:
    """From a tick on, a track is drawn in a colour ("#rrggbb") and width [px], or not at all."""

    tick: int
    color: str
    width: int
    drawn: bool = True


@dataclass(frozen=True)
class Track:
    """Where something was, in pixels of the scene's picture.

    Attributes:
        name: its own.
        ticks: when, int64 (n,).
        x, y: where [px, y down], float64 (n,); not a number where it was nowhere.
        theta: its heading [rad], float64 (n,).
        pens: how it is drawn, in order; the first from tick 0 on.
    """

    name: str
    ticks: npt.NDArray[np.int64]
    x: Floats
    y: Floats
    theta: Floats
    pens: tuple[PenChange, ...]


@dataclass(frozen=True)
class Rest:
    """What is driven stands still at (x, y) [m] from `time_s` [simulated s] on."""

    x: float
    y: float
    time_s: float


@dataclass(frozen=True)
class View:
    """A recording as a page can show it.

    Attributes:
        tracks: the one that the exercise is about first.
        cleared: ticks at which everything drawn before vanished.
        background: the picture's colour, "#rrggbb".
        rest: where the first track stood still at the end, if it had moved before.
        curves, calls: over time.
        drawn: what the picture shows at the end, in words, part by part.
    """

    tracks: tuple[Track, ...]
    cleared: tuple[int, ...]
    background: str
    rest: Rest | None
    curves: tuple[Curve, ...]
    calls: tuple[Call, ...]
    drawn: tuple[str, ...] = ()


class Plane(NamedTuple):
    """The picture of a scene; metres have y up.

    Attributes:
        size_px, size_m: its edge.
        metre_px: pixels in a metre.
        origin_m: x and y of its lower left corner.
    """

    size_px: int
    metre_px: float
    size_m: float
    origin_m: float = 0.0

    @property
    def end_m(self) -> float:
        """Where its upper right corner is, x and y."""
        return self.origin_m + self.size_m

    def to_px(self, x: float, y: float) -> tuple[float, float]:
        """A place in metres as pixels (y down)."""
        return (
            (x - self.origin_m) * self.metre_px,
            (self.end_m - y) * self.metre_px,
        )

    def holds(self, x: float, y: float, slack_m: float = 0.01) -> bool:
        """Whether a place is in it."""
        first, last = self.origin_m - slack_m, self.end_m + slack_m
        return first <= x <= last and first <= y <= last


@dataclass(frozen=True)
class Pictures:
    """The pictures of a recording by name; `window` is what a person would have seen at the end."""

    window: Pixels
    others: Mapping[str, Pixels] = field(default_factory=dict)
