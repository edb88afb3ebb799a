"""The original's number formats: float32 rounding, angles, C's printf."""

from __future__ import annotations

import math
from ctypes import c_float

#: The original computes with this macro, not with the closest double to pi [rad].
PI = 3.14159265


def float32(value: float) -> float:
    """Round to the nearest IEEE single, as a C++ assignment to `float` does.

    Values beyond the range of a single become infinite; nothing is raised.
    """
    return c_float(value).value


def normalize_angle(angle_rad: float) -> float:
    """Turn an angle into [-PI, PI) by the original's formula; NaN and infinities become NaN."""
    if not math.isfinite(angle_rad):
        return math.nan
    return angle_rad - (2.0 * PI * math.floor((angle_rad + PI) / (2.0 * PI)))


def cos(angle_rad: float) -> float:
    """C's cos: NaN where Python's raises."""
    return math.cos(angle_rad) if math.isfinite(angle_rad) else math.nan


def sin(angle_rad: float) -> float:
    """C's sin: NaN where Python's raises."""
    return math.sin(angle_rad) if math.isfinite(angle_rad) else math.nan


def printf_f(value: float) -> str:
    """C's `%f`, which shows the sign of a NaN."""
    if math.isnan(value):
        return "-nan" if math.copysign(1.0, value) < 0 else "nan"
    return f"{value:f}"


def fuzzy_equal(p: float, q: float) -> bool:
    """Qt 5's comparison of two coordinates (`operator==` of QPointF), relative 1e-12."""
    if p == 0.0 or q == 0.0:
        return abs(p - q) <= 1e-12
    difference = abs(p - q) * 1e12
    return difference <= abs(p) and difference <= abs(q)


def json_number(value: float, digits: int = 9) -> float | int | str:
    """Return a value for JSON: `digits` significant digits, NaN and inf as strings."""
    if not math.isfinite(value):
        return "nan" if math.isnan(value) else ("inf" if value > 0 else "-inf")
    # 17 digits tell every double from its neighbours
    rounded = float(value) if digits >= 17 else float(f"{value:.{digits}g}")
    return int(rounded) if rounded.is_integer() and abs(rounded) < 1e15 else rounded
