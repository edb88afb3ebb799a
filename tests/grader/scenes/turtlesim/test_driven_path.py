"""What a driven path tells of ways that are laid out by hand, and of none at all."""

import math

import numpy as np
import pytest

from grader.recording.subject import Start
from grader.scenes.turtlesim.driven_path import DrivenPath
from grader.testing import drive
from turtlesim_py.world.trajectory import Trajectory

TICK_S = 0.016
RECORDING = drive(lambda *_: None, ticks=1)


def path(*places, speed=1.0, theta=0.0, number=0):
    """A path through places (x, y), one a tick from tick 1 on."""
    rows = [(tick, x, y, theta, speed, 0.0, 0, 0, 0) for tick, (x, y) in enumerate(places, start=1)]
    way = Trajectory.of_rows(np.array(rows, dtype=np.float64).reshape(-1, 9))
    return DrivenPath(RECORDING, way, number)


def test_motion_has_a_first_and_a_last_row_a_length_and_a_rest_without_turns():
    driven = path((1, 1), (1, 1), (4, 5), (4, 6), (4, 6), (4, 6))
    assert driven.moving.tolist() == [False, False, True, True, False, False]
    assert (driven.first, driven.last, driven.rest, driven.stop_tick) == (1, 3, 3, 4)
    assert driven.length_m == 6
    assert driven.length_from(2) == 1
    assert driven.rested_s == pytest.approx(2 * TICK_S)
    way = path((1, 1), (2, 1), (2, 1), (2, 1)).way
    way.theta[2:] = 0.5
    driven = DrivenPath(RECORDING, way)
    assert (driven.last, driven.rest) == (1, 2)


def test_distances_are_to_a_place_and_to_the_nearest_wall():
    driven = path((1, 2), (10, 5))
    assert driven.distance_from(1, 5).tolist() == [3, 9]
    assert driven.wall_distance.tolist() == pytest.approx([1, 1.088889], abs=1e-6)
    assert driven.wall is None
    assert path((1, 1), (0, 1)).wall == 1
    assert path((1, 1), (1, driven.size_m)).wall == 1


def test_it_is_cut_where_a_pose_is_no_number_and_before_ticks():
    driven = path((1, 1), (2, 1), (math.nan, 1), (math.inf, 1), (3, 1))
    assert driven.lost == 2
    assert driven.until_lost().x.tolist() == [1, 2]
    assert driven.steps_m[1] == 1
    driven = path((1, 1), (1.01, 1), (5, 5), (5.01, 5), (5.02, 5), (9, 9))
    parts = driven.stretches([6, 3, 3])
    assert [part.ticks.tolist() for part in parts] == [[1, 2], [3, 4, 5], [6]]
    assert driven.longest_stretch([3, 6]).ticks.tolist() == [3, 4, 5]


def test_between_jumps_that_speed_does_not_explain_it_drove_alone():
    driven = path((1, 1), (1.016, 1), (3, 1), (3.016, 1))
    assert driven.jumping.tolist() == [False, False, True, False]
    driven = path((1, 1), (3, 3), (3, 3), (3.01, 3), (3.02, 3), (7, 7), (7.01, 7))
    assert driven.between_jumps().ticks.tolist() == [3, 4, 5]
    assert path((1, 1), (1, 1)).between_jumps().ticks.tolist() == [2]


def test_where_it_was_put_can_be_made_its_first_reading():
    driven = path((1.1, 1), (1.2, 1)).begun_at(Start(1.0, 1.0, 0.5))
    assert (driven.ticks.tolist(), driven.x[0], driven.linear[0]) == ([0, 1, 2], 1.0, 0.0)
    assert driven.first == 0


def test_the_first_return_is_the_nearest_place_of_the_first_visit_after_it_was_away():
    driven = path((1, 1), (1.1, 1), (3, 1), (1.2, 1), (1.1, 1), (1.3, 1), (1, 1))
    assert driven.first_return(0.25, away_m=1.0) == 4
    assert driven.first_return(0.25, away_m=2.5) is None


def test_sides_turn_into_each_other_and_those_of_a_closed_path_into_the_first():
    corners = [(1, 1), (3, 1), (3, 3), (1, 3)]
    found = path(*corners).sides(0.1)
    assert [(side.last, side.length_m, side.turn_deg) for side in found] == [
        *((1, 2, pytest.approx(90)), (2, 2, pytest.approx(90)), (3, 2, None))
    ]
    closed = path(*corners, (1, 1)).sides(0.1, closed_m=0.5)
    assert [side.turn_deg for side in closed] == pytest.approx([90] * 4)
    found = path((2, 1), (3, 1), (3, 3), (1, 3), (1, 1), (1.9, 1)).sides(0.05, closed_m=0.5)
    assert [(side.last, side.length_m) for side in found] == [
        *((1, pytest.approx(1.9)), (2, 2), (3, 2), (4, 2))
    ]
    assert [side.turn_deg for side in found] == pytest.approx([90] * 4)


def test_evidence_names_run_tick_time_and_place():
    driven = path((1.23456, 2), (3, 4), number=2)
    first = driven.evidence(0, "here")
    assert (first.tick, first.time_s, first.x, first.y, first.run) == (1, 0.016, 1.235, 2, 2)
    assert (driven.at(2, "").x, driven.at(99, "").x, driven.at(-5, "").x) == (3, 3, 1.235)
    assert str(driven.place(0)) == "(1.23, 2.00)"


def test_a_path_without_a_reading_answers_everything():
    driven = path()
    assert (len(driven), driven.first, driven.last, driven.stop_tick) == (0, 0, 0, 0)
    assert (driven.length_m, driven.rested_s, driven.wall, driven.lost) == (0, 0, None, None)
    assert driven.at(7, "nowhere").place is None
    assert len(driven.longest_stretch([3]).until_lost().between_jumps()) == 0
    assert (driven.sides(0.1, closed_m=1.0), driven.first_return(0.2, away_m=1.0)) == ([], None)
