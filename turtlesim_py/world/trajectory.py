"""What one turtle published, tick by tick, as columns with names."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

from turtlesim_py.world.turtle import Reading

#: The order of the columns in a row, as in the recordings of the original.
COLUMNS: Final = (
    *("tick", "x", "y", "theta", "linear_velocity", "angular_velocity"),
    *("r", "g", "b"),
)

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Trajectory:
    """n readings of a turtle; every array has one entry a reading.

    The floats are float32 values, as published. A turtle that was killed and spawned again has gaps
    in its ticks.

    Attributes:
        ticks: when, int64 (n,); 1 is the first tick of a recording.
        x, y: where [m], float64 (n,); y grows up. NaN after a command that was not a number.
        theta: the heading [rad], float64 (n,).
        linear, angular: the published speeds [m/s, rad/s], float64 (n,); linear is never negative.
        rgb: the colour under the turtle, uint8 (n, 3).
    """

    ticks: NDArray[np.int64]
    x: Floats
    y: Floats
    theta: Floats
    linear: Floats
    angular: Floats
    rgb: NDArray[np.uint8]

    @classmethod
    def of_rows(cls, rows: NDArray[np.float64]) -> Self:
        """Return the trajectory of an array (n, 9) in the order of `COLUMNS`.

        Raises:
            ValueError: it has another shape.
        """
        if rows.ndim != 2 or rows.shape[1] != len(COLUMNS):
            expected = f"expected rows of {len(COLUMNS)} columns"
            raise ValueError(f"{expected}, found the shape {rows.shape}")
        ticks, x, y, theta, linear, angular = rows[:, :6].T
        rgb = rows[:, 6:].astype(np.uint8)
        return cls(ticks.astype(np.int64), x, y, theta, linear, angular, rgb)

    @classmethod
    def of_readings(cls, readings: list[tuple[int, Reading]]) -> Self:
        """Return the trajectory of readings with their ticks."""
        rows = [(tick, *pose, *color) for tick, (pose, color) in readings]
        return cls.of_rows(np.array(rows, dtype=np.float64).reshape(-1, len(COLUMNS)))

    def rows(self) -> Floats:
        """Return a float64 array (n, 9) in the order of `COLUMNS`."""
        columns = (self.ticks, self.x, self.y, self.theta, self.linear, self.angular)
        return np.column_stack((*columns, self.rgb)).astype(np.float64)

    def __len__(self) -> int:
        return len(self.ticks)

    def __getitem__(self, which: slice | NDArray[np.bool_]) -> Self:
        """Return a slice of the readings, or those where a mask is true."""
        return type(self)(*(getattr(self, column.name)[which] for column in fields(self)))
