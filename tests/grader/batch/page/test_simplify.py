"""A simplified line has fewer points and is nowhere farther off than it may be."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from grader.batch.page.simplify import pieces, simplified


def off(points, line):
    """How far the farthest point is from a line."""
    starts, ways = line[:-1], np.diff(line, axis=0)
    squared = np.maximum((ways**2).sum(axis=1), 1e-300)
    along = ((points[:, None] - starts) * ways).sum(axis=2) / squared
    nearest = starts + np.clip(along, 0, 1)[..., None] * ways
    return np.linalg.norm(points[:, None] - nearest, axis=2).min(axis=1).max()


@given(
    arrays(
        np.float64,
        st.tuples(st.integers(2, 30), st.just(2)),
        elements=st.integers(0, 1000).map(float),
    )
)
def test_no_point_is_farther_off_than_the_tolerance(points):
    line = simplified(points, 5.0)
    assert len(line) <= len(points)
    assert np.array_equal(line[[0, -1]], points[[0, -1]])
    assert off(points, line) <= 5.0 + 1e-6


def test_a_straight_line_is_its_two_ends():
    points = np.column_stack([np.arange(100.0), np.arange(100.0)])
    assert simplified(points, 0.5).tolist() == [[0, 0], [99, 99]]


def test_a_line_of_no_end_is_thinned_out_and_keeps_its_own():
    points = np.column_stack([np.arange(50_001.0), np.arange(50_001) % 2 * 100.0])
    line = simplified(points, 0.5)
    assert len(line) <= 2001
    assert line[-1].tolist() == [50_000, 0]


def test_a_line_is_cut_where_it_was_nowhere():
    x = np.array([np.nan, 1, 2, np.inf, 3, np.nan, 4, 5])
    assert [piece.tolist() for piece in pieces(x, x)] == [[[1, 1], [2, 2]], [[4, 4], [5, 5]]]
    assert pieces(x[:0], x[:0]) == []
