"""A line of fewer points that looks the same."""

from __future__ import annotations

import numpy as np

from grader.scenes.view import Floats

#: A line with more points is thinned out evenly first: simplifying can take time with their square.
_MOST_POINTS = 2000


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
    step = max(1, -(-len(points) // _MOST_POINTS))
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
