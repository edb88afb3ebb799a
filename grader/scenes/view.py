"""A trace as people see it: pictures, tracks in a plane, curves over time, calls, and parts.

A scene makes these; a page draws them and knows nothing else of a scene. A scene that has nothing
of a kind leaves it empty, and the page has no place for it. Every text in them may come from a
submission: it is clipped here, and escaped by the page.

Parts are what else there is to see, in the order in which a page shows them: a `Solid` can be
turned and follows the time, a `Tree` is drawn from its top, a `Table` has rows.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, NamedTuple

import numpy as np
import numpy.typing as npt

from grader.text.message import NOTHING, Message, Text

Floats = npt.NDArray[np.float64]
#: Times from the start of a run [ns].
Times = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Curve:
    """A quantity over time.

    Attributes:
        title, unit: what it shows.
        times_ns: when, int64 (n,).
        values: float64 (n,); not a number where it has no value.
    """

    title: Message
    unit: str
    times_ns: Times
    values: Floats


@dataclass(frozen=True)
class Call:
    """A call of the submission.

    Attributes:
        name: its kind.
        time_ns: when.
        color: "#rrggbb", where it names one.
        text: its arguments, colours in words too; '' where the name is enough.
        where: the part of the picture in which it happened, in words; '' for none.
    """

    name: str
    time_ns: int
    color: str = ""
    text: Message = NOTHING
    where: Message = NOTHING


@dataclass(frozen=True)
class PenChange:
    """From a time on, a track is drawn in a colour ("#rrggbb") and width [px], or not at all."""

    time_ns: int
    color: str
    width: int
    drawn: bool = True


@dataclass(frozen=True)
class Track:
    """The track of something, in pixels of the scene's picture.

    Attributes:
        name: of what it is the track.
        times_ns: when, int64 (n,).
        x, y: where [px, y down], float64 (n,); not a number where it was nowhere.
        theta: its heading [rad], float64 (n,).
        pens: how it is drawn, in order; the first from the start on.
    """

    name: str
    times_ns: Times
    x: Floats
    y: Floats
    theta: Floats
    pens: tuple[PenChange, ...]


@dataclass(frozen=True)
class Rest:
    """The turtle or robot stands still at (x, y) [m] from `time_s` [simulated s] on."""

    x: float
    y: float
    time_s: float


class Placing(NamedTuple):
    """The pose of a solid's frame in its parent: x, y, z [m] and a quaternion x, y, z, w."""

    at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    turned: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True)
class SolidFrame:
    """A frame in which shapes of a solid lie.

    Attributes:
        name: a robot's link.
        parent: the number of the frame in which this one is; -1 for the ground's. It is smaller
            than this one's own.
        placings: where in it, at each of the solid's times, or once where that never changes;
            None where it is not known.
    """

    name: str
    parent: int
    placings: tuple[Placing | None, ...]


@dataclass(frozen=True)
class Shape:
    """A shape of a solid.

    Attributes:
        frame: the number of its frame.
        placing: in that.
        sizes: of a box x, y, z; of a cylinder radius and length, along z; of a sphere the radius
            [m]; of triangles nine numbers each.
        color: "#rrggbb".
        alpha: 0 to 1, which hides all behind.
    """

    kind: Literal["box", "cylinder", "sphere", "triangles"]
    frame: int
    placing: Placing
    sizes: tuple[float, ...]
    color: str
    alpha: float = 1.0


@dataclass(frozen=True)
class Solid:
    """A thing in space that can be seen from all sides.

    A frame without a placing is drawn at the origin of the ground's, white.

    Attributes:
        title: what it is.
        text: what there is to see, in words.
        frames, shapes: what it is made of.
        times_ns: when the frames are placed; () where no time passes.
        ground_m: the height of the ground; None: that of its lowest point.
        way: where it went on the ground, float64 (n, 2) [m].
        lost: the names of the frames that have no placing at the end.
        left_out: what belongs to it and is not drawn, in words.
    """

    title: Message
    text: Message
    frames: tuple[SolidFrame, ...]
    shapes: tuple[Shape, ...]
    times_ns: tuple[int, ...] = ()
    ground_m: float | None = 0.0
    way: Floats = field(default_factory=lambda: np.empty((0, 2)))
    lost: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()


@dataclass(frozen=True)
class TreeNode:
    """A node of a tree.

    Attributes:
        depth: 0 for a root.
        name, text: what it is, and more about it, in a line each.
        mark: `lost` - it should have a parent and has none; `wrong` - something is at odds.
    """

    depth: int
    name: str
    text: Message
    mark: Literal["", "lost", "wrong"] = ""


@dataclass(frozen=True)
class Tree:
    """A tree, as a list: each node comes after its parent, with all of its own below it."""

    title: Message
    nodes: tuple[TreeNode, ...]
    note: Message = NOTHING


class Cell(NamedTuple):
    """A cell of a table: lines of text, and whether something of it is missing or wrong."""

    lines: tuple[Text, ...]
    is_wrong: bool = False


@dataclass(frozen=True)
class Table:
    """Rows under headings; each row has as many cells as there are headings.

    Attributes:
        title: what it shows.
        note: a text before it; '' for none.
    """

    title: Message
    headings: tuple[Message, ...]
    rows: tuple[tuple[Cell, ...], ...]
    note: Message = NOTHING


Part = Solid | Tree | Table


@dataclass(frozen=True)
class View:
    """A recording as a page can show it.

    Attributes:
        tracks: the one that the exercise is about first.
        step_ns: tracks are recorded at multiples of this [ns].
        cleared: times at which everything drawn before vanished.
        background: the picture's colour, "#rrggbb".
        rest: where the first track stood still at the end, if it had moved before.
        curves, calls: over time.
        drawn: what the picture shows at the end, in words, part by part.
        parts: whatever else there is to see.
    """

    tracks: tuple[Track, ...] = ()
    step_ns: int = 1_000_000
    cleared: tuple[int, ...] = ()
    background: str = "#ffffff"
    rest: Rest | None = None
    curves: tuple[Curve, ...] = ()
    calls: tuple[Call, ...] = ()
    drawn: tuple[Message, ...] = ()
    parts: tuple[Part, ...] = ()


class Plane(NamedTuple):
    """The picture of a subject; metres have y up.

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
        """The x and y of its upper right corner [m]."""
        return self.origin_m + self.size_m

    def to_px(self, x: float, y: float) -> tuple[float, float]:
        """A place in metres as pixels (y down)."""
        return (x - self.origin_m) * self.metre_px, (self.end_m - y) * self.metre_px

    def holds(self, x: float, y: float, slack_m: float = 0.01) -> bool:
        first, last = self.origin_m - slack_m, self.end_m + slack_m
        return first <= x <= last and first <= y <= last
