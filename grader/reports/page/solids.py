"""A solid as the page's script draws it: short lists of rounded numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from grader.scenes.view import Placing, Shape, Solid

#: What is smaller is not seen [digits of a metre, of a quaternion].
_PLACE, _TURN, _SIZE = 4, 4, 5
_KINDS = {"box": 0, "cylinder": 1, "sphere": 2, "triangles": 3}


@dataclass(frozen=True)
class Turnable:
    """A solid in a page.

    Attributes:
        solid: what it is made of.
        data: for the script: `t` the times [s], `frames` each its parent and placings, `shapes`
            each its kind, frame, placing, sizes, colour and alpha, `ground` and `way`.
    """

    solid: Solid
    data: dict[str, Any]


def turnable(solid: Solid, tick_s: float) -> Turnable:
    """A solid of a recording with ticks of so many seconds."""
    data = {
        "t": [round(tick * tick_s, 2) for tick in solid.ticks],
        "frames": [
            [frame.parent, [_placing(each) for each in frame.placings]] for frame in solid.frames
        ],
        "shapes": [_shape(each) for each in solid.shapes],
        "ground": round(solid.ground_m, _PLACE),
        "way": solid.way.round(3).tolist(),
    }
    return Turnable(solid, data)


def _shape(shape: Shape) -> list[Any]:
    sizes = [round(size, _SIZE) for size in shape.sizes]
    placing = _placing(shape.placing)
    return [_KINDS[shape.kind], shape.frame, placing, sizes, shape.color, round(shape.alpha, 2)]


def _placing(placing: Placing | None) -> list[float] | None:
    if placing is None:
        return None
    at = [round(value, _PLACE) + 0.0 for value in placing.at]
    return [*at, *(round(value, _TURN) + 0.0 for value in placing.turned)]
