import math
from dataclasses import fields

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from turtlesim_py.world.trajectory import COLUMNS, Trajectory
from turtlesim_py.world.turtle import Pose, Reading

ROWS = np.array(
    [
        [1, 0.5, 1.5, 2.5, 3.5, 4.5, 0, 1, 2],
        [2, -0.0, math.nan, math.inf, 0.0, -4.5, 253, 254, 255],
        [7, 1e-45, 3.4e38, -math.pi, 1.0, 0.0, 179, 184, 255],
    ]
)


@pytest.fixture
def way():
    return Trajectory.of_rows(ROWS)


@st.composite
def rows(draw):
    count = draw(st.integers(0, 5))
    made = np.zeros((count, len(COLUMNS)))
    made[:, 0] = sorted(draw(st.sets(st.integers(0, 2**40), min_size=count, max_size=count)))
    values = st.lists(st.floats(), min_size=count, max_size=count)
    for column in range(1, 6):
        made[:, column] = draw(values)
    for column in range(6, 9):
        made[:, column] = draw(st.lists(st.integers(0, 255), min_size=count, max_size=count))
    return made


def test_every_column_has_its_name_and_type(way):
    assert way.ticks.tolist() == [1, 2, 7]
    assert way.x.tolist() == [0.5, -0.0, 1e-45]
    assert way.y[[0, 2]].tolist() == [1.5, 3.4e38]
    assert math.isnan(way.y[1])
    assert way.theta.tolist() == [2.5, math.inf, -math.pi]
    assert way.linear.tolist() == [3.5, 0.0, 1.0]
    assert way.angular.tolist() == [4.5, -4.5, 0.0]
    assert way.rgb.tolist() == [[0, 1, 2], [253, 254, 255], [179, 184, 255]]
    floats = ("x", "y", "theta", "linear", "angular")
    types = {"ticks": np.int64, "rgb": np.uint8} | dict.fromkeys(floats, np.float64)
    assert {f.name: getattr(way, f.name).dtype for f in fields(way)} == types


def test_the_order_of_the_columns_is_that_of_the_original_s_recordings():
    assert (
        *("tick", "x", "y", "theta", "linear_velocity", "angular_velocity"),
        *("r", "g", "b"),
    ) == COLUMNS


@given(rows=rows())
def test_rows_come_back_bit_for_bit(rows):
    back = Trajectory.of_rows(rows).rows()
    assert (back.shape, back.dtype) == (rows.shape, np.float64)
    assert back.tobytes() == rows.tobytes()


def test_readings_are_rows_with_their_ticks():
    readings = [
        (3, Reading(Pose(1.0, 2.0, 3.0, 4.0, 5.0), (6, 7, 8))),
        (9, Reading(Pose(-0.0, math.inf, 0.5, 0.0, -1.0), (255, 0, 255))),
    ]
    way = Trajectory.of_readings(readings)
    expected = np.array([[3, 1, 2, 3, 4, 5, 6, 7, 8], [9, -0.0, math.inf, 0.5, 0, -1, 255, 0, 255]])
    assert way.rows().tobytes() == expected.tobytes()


def test_no_readings_are_an_empty_trajectory_with_all_its_columns():
    for empty in (Trajectory.of_readings([]), Trajectory.of_rows(np.zeros((0, 9)))):
        assert len(empty) == 0
        assert empty.rows().shape == (0, 9)
        assert empty.rgb.shape == (0, 3)
        assert all(len(getattr(empty, f.name)) == 0 for f in fields(empty))


@pytest.mark.parametrize("shape", [(9,), (3, 8), (1, 3, 9)])
def test_rows_of_another_shape_are_refused(shape):
    with pytest.raises(ValueError, match="expected rows of 9 columns, found the shape"):
        Trajectory.of_rows(np.zeros(shape))


@pytest.mark.parametrize(
    "which",
    [slice(1, None), slice(None, None, 2), slice(5, 9), np.array([True, False, True])],
)
def test_a_part_has_the_same_readings_in_every_column(way, which):
    part = way[which]
    assert isinstance(part, Trajectory)
    assert part.rows().tobytes() == ROWS[which].tobytes()
    assert len(part) == len(ROWS[which])
