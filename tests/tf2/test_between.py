"""What is between two samples, and along random trees: against formulas of another kind."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from tf2_py import BufferCore

from .transforms import at, matrix, quaternion, transform, xyz

numbers = st.floats(-100, 100, allow_subnormal=False)
points = st.tuples(numbers, numbers, numbers)
parts = st.floats(-1, 1, allow_subnormal=False)
quaternions = (
    st.tuples(parts, parts, parts, parts)
    .filter(lambda q: math.hypot(*q) > 0.1)
    .map(lambda q: tuple(part / math.hypot(*q) for part in q))
)
poses = st.tuples(points, quaternions)


def turned(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rodrigues' formula: the matrix of a rotation about a unit vector."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def rotation_between(a: np.ndarray, b: np.ndarray, ratio: float) -> np.ndarray:
    """The rotation from a to b about its axis, by `ratio` of the angle, at most half a turn."""
    way = a.T @ b
    twist = np.array([way[2, 1] - way[1, 2], way[0, 2] - way[2, 0], way[1, 0] - way[0, 1]])
    angle = math.atan2(np.linalg.norm(twist), np.trace(way) - 1)
    if np.linalg.norm(twist) < 1e-12:
        return a
    return a @ turned(twist / np.linalg.norm(twist), ratio * angle)


@given(poses, poses, st.floats(0.01, 0.99))
def test_between_two_samples_it_goes_straight_and_turns_evenly_the_shorter_way(first, last, ratio):
    buffer = BufferCore()
    ends = [transform("a", "b", t, *pose) for t, pose in ((10, first), (11, last))]
    for end in ends:
        buffer.set_transform(end, "a test")
    found = buffer.lookup_transform_core("a", "b", at(10 + ratio))
    a, b = map(matrix, ends)
    # not half a turn: both ways are as short
    assume(np.trace(a[:3, :3].T @ b[:3, :3]) > -1 + 1e-6)
    ratio = at(ratio).nanoseconds / 1e9
    assert xyz(found) == pytest.approx(a[:3, 3] + ratio * (b[:3, 3] - a[:3, 3]), abs=1e-9)
    expected = rotation_between(a[:3, :3], b[:3, :3], ratio)
    np.testing.assert_allclose(matrix(found)[:3, :3], expected, atol=1e-7)


@st.composite
def trees(draw):
    """Frames f0, f1, ... of one tree in any order of coming, each below one with a smaller number.

    Returns their parents by number and their poses, of which the first is of no use.
    """
    size = draw(st.integers(2, 12))
    parents = [0, *(draw(st.integers(0, child - 1)) for child in range(1, size))]
    order = draw(st.permutations(range(1, size)))
    return parents, draw(st.lists(poses, min_size=size, max_size=size)), order


@given(trees(), st.data())
def test_in_any_tree_it_finds_what_multiplied_matrices_give(tree, data):
    parents, all_poses, order = tree
    messages = {
        child: transform(f"f{parents[child]}", f"f{child}", 5, *all_poses[child]) for child in order
    }
    static = data.draw(st.sets(st.sampled_from(order)))
    buffer = BufferCore()
    for child, message in messages.items():
        put = buffer.set_transform_static if child in static else buffer.set_transform
        put(message, "a test")
    in_root = [np.eye(4)]
    for child in range(1, len(parents)):
        in_root.append(in_root[parents[child]] @ matrix(messages[child]))
    target, source = (data.draw(st.integers(0, len(parents) - 1)) for _ in range(2))
    time = data.draw(st.sampled_from([0, 5]))
    found = buffer.lookup_transform_core(f"f{target}", f"f{source}", at(time))
    expected = np.linalg.inv(in_root[target]) @ in_root[source]
    np.testing.assert_allclose(matrix(found), expected, atol=1e-9)
    assert math.hypot(*quaternion(found)) == pytest.approx(1, abs=1e-12)
