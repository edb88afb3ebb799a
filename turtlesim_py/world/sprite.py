"""A turtle's picture as the arena knows it: its name and its place; `picture` draws it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

#: The names of the pictures, in the original's order.
NAMES: Final = (
    *("ardent", "bouncy", "crystal", "dashing", "eloquent", "foxy", "galactic", "humble"),
    *("iron", "jazzy", "rolling"),
)


@dataclass(frozen=True)
class Sprite:
    """A turtle as the window shows it.

    Attributes:
        x_px, y_px: its centre on the canvas, y down. Where one is not finite, the edge of the
            turtle's picture lies on the edge of the window, as in the original.
        heading_rad: 0 is to the right, positive turns to the left. A turtle whose heading is
            not finite is invisible, as in the original.
        name: one of `NAMES`.
    """

    x_px: float
    y_px: float
    heading_rad: float
    name: str
