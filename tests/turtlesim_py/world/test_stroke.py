"""The pixels of a stroke: recorded lines of the real Qt, and what holds for every line."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from turtlesim_py.world.stroke import spans

GOLDEN = Path(__file__).parents[2] / "golden"

widths = st.integers(0, 255)
inside = st.floats(20.0, 480.0)
anything = st.floats()


def pixels(ax, ay, bx, by, width):
    return [
        (row, column)
        for row, first, last in spans(ax, ay, bx, by, width)
        for column in range(first, last + 1)
    ]


def test_2700_recorded_lines_of_qt_are_repeated_pixel_for_pixel():
    with np.load(GOLDEN / "lines.npz") as recorded:
        lines, painted = recorded["lines"], recorded["painted"]
    wrong = []
    for (ax, ay, bx, by, width), expected in zip(lines.tolist(), painted, strict=True):
        mask = bytearray(500 * 504)  # as recorded: rows of 500 pixels, filled up to whole bytes
        for row, first, last in spans(ax, ay, bx, by, int(width)):
            start = row * 504
            mask[start + first : start + last + 1] = b"\1" * (last - first + 1)
        drawn = np.packbits(np.frombuffer(mask, np.uint8)).reshape(500, 63)
        if drawn.tobytes() != expected.tobytes():
            wrong.append((ax, ay, bx, by, width))
    assert wrong == []
    assert len(lines) == 2700


@given(anything, anything, anything, anything, widths)
@example(0.0, 0.0, 5e-324, 0.0, 3)
@example(1e-200, 1e-200, 3e-200, 1e-200, 3)
@example(-1.7e308, 1.7e308, 1.7e308, -1.7e308, 3)
@example(1e40, -1e40, -1e41, 1e39, 1)
def test_any_line_stays_inside_the_image_and_paints_no_pixel_twice(ax, ay, bx, by, width):
    painted = pixels(ax, ay, bx, by, width)
    assert len(set(painted)) == len(painted)
    assert all(0 <= row < 500 for row, _ in painted)
    assert all(0 <= column < 500 for _, column in painted)


@pytest.mark.parametrize("width", [0, 1, 255])
@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_a_coordinate_that_is_not_finite_draws_nothing(value, width):
    for place in range(4):
        line = [100.0, 110.0, 120.0, 130.0]
        line[place] = value
        assert spans(*line, width) == []


@given(st.integers(100, 1900), st.integers(100, 1900), st.integers(2, 40))
def test_equal_points_make_a_square_as_wide_as_the_pen(x_quarters, y_quarters, width):
    x, y = x_quarters / 4.0, y_quarters / 4.0
    painted = pixels(x, y, x, y, width)
    rows, columns = {row for row, _ in painted}, {column for _, column in painted}
    assert len(painted) == width * width
    assert len(rows) == len(columns) == width
    assert abs(sum(rows) / width + 0.5 - y) <= 0.5
    assert abs(sum(columns) / width + 0.5 - x) <= 0.5


@given(inside, inside, inside, inside)
def test_width_0_is_width_1(ax, ay, bx, by):
    assert spans(ax, ay, bx, by, 0) == spans(ax, ay, bx, by, 1)


@given(inside, inside, inside, inside)
def test_a_thin_line_paints_the_same_pixels_in_both_directions(ax, ay, bx, by):
    assert spans(ax, ay, bx, by, 1) == spans(bx, by, ax, ay, 1)


@given(inside, inside, inside, inside, st.integers(2, 20))
def test_a_wide_line_that_is_not_nearly_horizontal_paints_the_same_in_both_directions(
    ax, ay, bx, by, width
):
    if abs(ay - by) > 1.0 / 32.0:
        assert spans(ax, ay, bx, by, width) == spans(bx, by, ax, ay, width)


def test_a_nearly_horizontal_line_lies_at_the_height_of_its_first_point():
    forth = {row for row, _ in pixels(100.0, 100.495, 120.0, 100.505, 2)}
    back = {row for row, _ in pixels(120.0, 100.505, 100.0, 100.495, 2)}
    assert (forth, back) == ({99, 100}, {100, 101})


def test_a_thin_line_within_one_cell_of_the_grid_is_lost():
    assert spans(100.1, 100.1, 100.105, 100.1, 1) == []
    assert spans(100.1, 100.1, 100.1, 100.1, 1) == [(100, 100, 100)]


def test_a_thin_dot_is_rounded_where_a_thin_line_is_cut_down():
    assert spans(10.7, 20.7, 10.7, 20.7, 1) == [(21, 11, 11)]
    assert spans(10.7, 20.7, 12.7, 20.7, 1) == [(20, 10, 12)]


def test_a_thin_dot_far_to_the_left_appears_at_the_edge_because_qt_rounds_with_ints():
    assert spans(-1e10, 49.5, -1e10, 49.5, 1) == [(50, 0, 0)]
    assert spans(-1e9, 49.5, -1e9, 49.5, 1) == []
    assert spans(1e10, 49.5, 1e10, 49.5, 1) == []


def test_square_caps_reach_half_a_width_beyond_both_ends():
    assert spans(100.0, 50.0, 110.0, 50.0, 4) == [(row, 98, 111) for row in (48, 49, 50, 51)]
    assert spans(50.0, 100.0, 50.0, 110.0, 4) == [(row, 48, 51) for row in range(98, 112)]


def test_a_line_across_the_whole_image_from_very_far_away_is_drawn():
    painted = pixels(-1e15, 250.0, 1e15, 250.0, 3)
    assert len(painted) == 3 * 500
