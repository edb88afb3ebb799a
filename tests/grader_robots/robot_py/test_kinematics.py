"""Where links are: against yourdfpy and MuJoCo, against naive products, and what KDL does."""

import json
import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from grader_robots.robot_py import kinematics
from grader_robots.robot_py.model import Joint, JointType, Link, Mimic, Model, Origin
from grader_robots.robot_py.urdf import parse

ROBOTS = Path(__file__).parent / "robots"
#: Where yourdfpy 0.0.60 and MuJoCo 4.0.0 see the links, which agree to 1e-12. (They do not where a
#: prismatic axis is not of length 1: yourdfpy takes it as it is, MuJoCo and KDL do not.)
SECOND_OPINIONS = json.loads((ROBOTS / "frames.json").read_text())

ANGLES = st.floats(-7, 7)
LENGTHS = st.floats(-3, 3)
VECTORS = st.tuples(LENGTHS, LENGTHS, LENGTHS)
TURNS = st.tuples(ANGLES, ANGLES, ANGLES)
AXES = VECTORS.filter(lambda axis: math.hypot(*axis) > 0.01)
TYPES = st.sampled_from(list(JointType))


def chain(*joints: Joint) -> Model:
    names = {"root", *(joint.child for joint in joints), *(joint.parent for joint in joints)}
    links = {name: Link(name) for name in sorted(names)}
    return Model("test", "root", links, {joint.name: joint for joint in joints})


def joint(kind: str, name: str = "j", parent: str = "root", child: str = "tip", **more) -> Joint:
    more.setdefault("axis", (0.0, 0.0, 1.0))
    return Joint(name, JointType(kind), parent, child, **more)


@pytest.mark.parametrize("number", range(len(SECOND_OPINIONS)))
def test_links_are_where_yourdfpy_and_mujoco_see_them(number):
    opinion = SECOND_OPINIONS[number]
    model = parse((ROBOTS / f"{opinion['robot']}.urdf").read_text()).model
    frames = kinematics.forward(model, kinematics.with_mimics(model, opinion["positions"]))
    assert sorted(frames) == sorted(opinion["frames"])
    for link, seen in opinion["frames"].items():
        np.testing.assert_allclose(frames[link], seen, rtol=0, atol=1e-12, err_msg=link)


@st.composite
def trees(draw) -> Model:
    joints = []
    for number in range(draw(st.integers(1, 8))):
        parent = draw(st.integers(0, number))
        joints.append(
            joint(
                draw(TYPES),
                f"joint{draw(st.integers(0, 99))}_{number}",
                f"link{parent}" if parent else "root",
                f"link{number + 1}",
                origin=Origin(draw(VECTORS), draw(TURNS)),
                axis=draw(AXES),
            )
        )
    return chain(*joints)


@given(trees(), st.lists(ANGLES, min_size=8, max_size=8))
def test_frames_are_the_product_of_what_the_joints_say(model, values):
    positions = dict(zip(model.joints, values, strict=False))
    frames = kinematics.forward(model, positions)
    assert frames.keys() == model.links.keys()
    for one in model.joints.values():
        expected = frames[one.parent] @ naive(one, positions[one.name])
        np.testing.assert_allclose(frames[one.child], expected, rtol=0, atol=1e-11)


def naive(one: Joint, position: float) -> np.ndarray:
    """Rz · Ry · Rx and Rodrigues' formula, by 4 x 4 matrices."""
    (roll, pitch, yaw), axis = one.origin.rpy, np.array(one.axis) / math.hypot(*one.axis)
    x, y, z = np.eye(3)
    turn = rodrigues(z, yaw) @ rodrigues(y, pitch) @ rodrigues(x, roll)
    placed, acted = np.eye(4), np.eye(4)
    placed[:3, :3], placed[:3, 3] = turn, one.origin.xyz
    if one.type == "prismatic":
        acted[:3, 3] = axis * position
    if one.type in ("revolute", "continuous"):
        acted[:3, :3] = rodrigues(axis, position)
    return placed @ acted


def rodrigues(axis: np.ndarray, angle: float) -> np.ndarray:
    cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


@given(TURNS)
def test_a_quaternion_has_length_1_and_says_what_the_matrix_says(rpy):
    matrix = kinematics.matrix(Origin((1.0, 2.0, 3.0), rpy))
    x, y, z, w = kinematics.quaternion(matrix)
    assert math.isclose(x * x + y * y + z * z + w * w, 1, abs_tol=1e-12)
    again = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    np.testing.assert_allclose(again, matrix[:3, :3], rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("rpy", "expected"),
    [
        ((0, 0, 0), (0, 0, 0, 1)),
        ((math.pi, 0, 0), (1, 0, 0, 0)),
        ((0, math.pi, 0), (0, 1, 0, 0)),
        ((0, 0, math.pi), (0, 0, 1, 0)),
        ((0, 0, math.pi / 2), (0, 0, math.sqrt(0.5), math.sqrt(0.5))),
        ((0, 0, 1.5 * math.pi), (0, 0, -math.sqrt(0.5), math.sqrt(0.5))),
    ],
)
def test_quaternions_have_their_known_values(rpy, expected):
    found = kinematics.quaternion(kinematics.matrix(Origin(rpy=rpy)))
    assert found == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("kind", ["revolute", "continuous", "prismatic"])
def test_a_joint_without_an_axis_yields_nan_as_in_kdl(kind):
    transform = kinematics.joint_transform(joint(kind, axis=(0.0, 0.0, 0.0)), 0.0)
    assert all(map(math.isnan, kinematics.translation(transform)))


@pytest.mark.parametrize("position", [math.nan, math.inf])
def test_a_position_that_is_no_number_is_passed_on(position):
    transform = kinematics.joint_transform(joint("revolute"), position)
    assert all(map(math.isnan, kinematics.translation(transform)))
    assert all(map(math.isnan, kinematics.quaternion(transform)))


def test_a_planar_joint_counts_as_fixed_and_a_floating_one_as_nothing():
    model = chain(
        joint("planar", "a", "root", "one"),
        joint("floating", "b", "one", "two"),
        joint("continuous", "d", "two", "four"),
        joint("fixed", "c", "two", "three"),
        joint("revolute", "0", "four", "five"),
    )
    tree = kinematics.tree(model)
    assert list(tree.fixed) == ["a", "c"]
    assert list(tree.moving) == ["0", "d"]


def test_a_link_with_two_parents_hangs_on_the_last_joint_by_the_alphabet():
    model = chain(
        joint("fixed", "z", "root", "left"),
        joint("fixed", "y", "root", "right"),
        joint("fixed", "b", "left", "tip"),
        joint("fixed", "a", "right", "tip"),
    )
    assert kinematics.tree(model).joints["tip"].name == "b"
    assert not kinematics.tree(model).is_endless


def test_links_that_go_round_below_the_root_are_noticed_and_out_of_reach_left_out():
    into = joint("fixed", "a", "root", "one")
    model = chain(into, joint("fixed", "b", "one", "two"), joint("fixed", "c", "two", "one"))
    assert kinematics.tree(model).is_endless
    assert kinematics.tree(chain(into, joint("fixed", "0", "one", "one"))).is_endless
    apart = chain(joint("fixed", "b", "one", "two"), joint("fixed", "c", "two", "one"))
    tree = kinematics.tree(apart)
    assert (tree.joints, tree.is_endless) == ({}, False)


def test_ten_thousand_links_in_a_row_are_no_matter():
    names = ["root", *(f"link{number}" for number in range(10_000))]
    pairs = enumerate(pairwise(names))
    joints = [joint("fixed", f"j{number}", *pair) for number, pair in pairs]
    assert len(kinematics.forward(chain(*joints), {})) == len(names)


def test_a_mimic_follows_and_a_given_position_wins():
    model = chain(
        joint("prismatic", "lead", "root", "one"),
        joint("prismatic", "shadow", "root", "two", mimic=Mimic("lead", -2.0, 0.5)),
    )
    assert kinematics.with_mimics(model, {"lead": 0.25})["shadow"] == 0.0
    assert kinematics.with_mimics(model, {"lead": 0.25, "shadow": 3.0})["shadow"] == 3.0
    assert kinematics.with_mimics(model, {"other": 0.25}) == {"other": 0.25}


@pytest.mark.parametrize(("middle", "is_moved"), [("b", True), ("d", False)])
def test_a_chain_of_mimics_works_where_the_middle_one_stands_first(middle, is_moved):
    model = chain(
        joint("prismatic", "a", "root", "one"),
        joint("prismatic", middle, "root", "two", mimic=Mimic("a")),
        joint("prismatic", "c", "root", "three", mimic=Mimic(middle)),
    )
    assert ("c" in kinematics.with_mimics(model, {"a": 1.0})) == is_moved
