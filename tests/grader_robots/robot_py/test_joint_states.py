"""joint_state_publisher without a node: joints, zeros, sources, mimics."""

import math
import re
from pathlib import Path

import pytest

from grader_robots.robot_py.joint_states import (
    JointStateOptions,
    JointStates,
    NodeEnded,
    UnusableDescription,
    Values,
    dependences,
)

ROBOTS = Path(__file__).parent / "robots"
WALKER = (ROBOTS / "walker.urdf").read_text()
ROVER = (ROBOTS / "rover.urdf").read_text()


def joint(name: str, lower: object = -1, upper: object = 1, more: str = "", kind="revolute") -> str:
    limit = f'<limit lower="{lower}" upper="{upper}" effort="1" velocity="1"/>'
    return f'<joint name="{name}" type="{kind}">{limit}{more}</joint>'


def robot(*joints: str) -> str:
    return f'<robot name="r">{"".join(joints)}</robot>'


def states(description: str, **options) -> JointStates:
    made = JointStates(JointStateOptions(**options))
    made.configure(description)
    return made


def positions(description: str, **options) -> dict[str, float]:
    values = states(description, **options).tick()
    return dict(zip(values.names, values.positions, strict=True))


def test_nothing_is_published_before_a_description_and_where_all_joints_are_fixed():
    assert JointStates().tick() is None
    kinds = ("fixed", "floating", "planar")
    assert states(robot(*(joint(kind, kind=kind) for kind in kinds))).tick() is None


def test_movable_joints_come_in_the_file_s_order_with_those_that_follow():
    values = states(ROVER).tick()
    assert values.names == [
        "left_wheel_joint",
        "right_wheel_joint",
        "lift",
        "palm_turn",
        "left_finger_joint",
        "right_finger_joint",
    ]
    assert values.positions == [0, 0, 0, 0, 0, 0.002]
    assert (values.velocities, values.efforts) == ([], [])


@pytest.mark.parametrize(
    ("lower", "upper", "zero"),
    [(-1, 1, 0), (0, 2, 0), (-2, 0, 0), (1, 2, 1.5), (-2, -1, -1.5), (3, -3, 0)],
)
def test_a_joint_stands_at_0_or_in_the_middle_of_its_limits(lower, upper, zero):
    assert positions(robot(joint("a", lower, upper))) == {"a": zero}


def test_a_parameter_says_another_zero_whatever_the_limits():
    assert positions(robot(joint("a")), zeros={"a": 5.0}) == {"a": 5.0}


@pytest.mark.parametrize(("heeded", "zero"), [(True, 0.6), (False, 0)])
def test_the_limits_of_a_safety_controller_count_where_they_are_smaller(heeded, zero):
    safety = '<safety_controller soft_lower_limit="0.5" soft_upper_limit="0.7"/>'
    found = positions(robot(joint("a", more=safety)), use_smallest_joint_limits=heeded)
    assert found == {"a": pytest.approx(zero)}


@pytest.mark.parametrize(
    ("options", "values"),
    [
        (("velocities", True), ([0.0], [0.0], [])),
        (("efforts", True), ([0.0], [], [0.0])),
        (("positions", False), ([], [], [])),
    ],
)
def test_what_is_published_by_default_can_be_asked_for(options, values):
    what, wanted = options
    made = states(robot(joint("a")), **{f"publish_default_{what}": wanted})
    assert made.tick() == Values(["a"], *values)


OF_A = 'joint "a" of type "revolute"'


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (robot('<joint name="a" type="revolute"/>'), f"Limits must be specified for {OF_A}"),
        (
            robot('<joint name="a" type="prismatic"><limit upper="1"/></joint>'),
            '"lower" limit must be specified for joint "a" of type "prismatic"',
        ),
        (
            robot('<joint name="a" type="revolute"><limit lower="1"/></joint>'),
            f'"upper" limit must be specified for {OF_A}',
        ),
        (robot(joint("a", "x")), '"lower" limit must be a float for joint "a" of type "revolute"'),
        (
            robot(joint("a", more='<mimic joint="b" multiplier="x"/>')),
            "could not convert string to float: 'x'",
        ),
        ("<a/>", 'URDF must have a "robot" tag'),
        ("", "no element found: line 1, column 0"),
        ("<robot>", "no element found: line 1, column 7"),
        ("<sdf/>", "robot_description is sdf: only URDF is read here"),
        ('<!DOCTYPE a [<!ENTITY x "y">]><robot/>', "declares entities"),
        ("<a>" * 20_000 + "</a>" * 20_000, ""),
    ],
)
def test_a_description_that_cannot_be_used_is_told_and_the_old_one_stays(text, why):
    made = states(robot(joint("old")))
    with pytest.raises(UnusableDescription) as caught:
        made.configure(text)
    assert why in str(caught.value)
    assert made.tick().names == ["old"]


def test_another_description_replaces_the_joints():
    made = states(WALKER)
    made.configure(robot(joint("new")))
    assert made.tick().names == ["new"]


def test_a_source_moves_free_joints_and_none_else():
    made = states(ROVER)
    made.hear(Values(["lift", "right_finger_joint", "other"], [0.3, 9.0, 9.0], [0.5, 1.0, 1.0]))
    values = made.tick()
    assert values.positions == [0, 0, 0.3, 0, 0, 0.002]
    assert values.velocities == [0, 0, 0.5, 0, 0, 0]


def test_who_follows_moves_with_what_a_source_says():
    made = states(ROVER)
    made.hear(Values(["left_finger_joint"], [0.01], [2.0], [3.0]))
    values = made.tick()
    assert values.positions[-1] == pytest.approx(0.9 * 0.01 + 0.002)
    assert (values.velocities[-1], values.efforts[-1]) == (1.8, 3.0)


def test_mimics_of_mimics_are_followed():
    text = robot(
        joint("c", more='<mimic joint="b" multiplier="2" offset="1"/>'),
        joint("a", 2, 4),
        joint("b", more='<mimic joint="a" multiplier="-3" offset="0.5"/>'),
    )
    assert positions(text) == {"c": 2 * (-3 * 3 + 0.5) + 1, "a": 3, "b": -3 * 3 + 0.5}


def test_mimics_that_are_not_heeded_are_free_joints():
    text = robot(joint("a", 2, 4), joint("b", more='<mimic joint="a"/>'))
    assert positions(text, use_mimic_tags=False) == {"a": 3, "b": 0}


CIRCLE = robot(
    joint("a", more='<mimic joint="b"/>'),
    joint("b", more='<mimic joint="c"/>'),
    joint("c", more='<mimic joint="b"/>'),
)
GONE = robot(joint("a", more='<mimic joint="gone"/>'))


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (CIRCLE, "Found an infinite recursive mimic chain: ['a', 'b', 'c', 'b']"),
        (GONE, 'joint "a" follows "gone", and no such joint moves'),
    ],
)
def test_who_follows_itself_or_what_is_not_there_ends_it(text, why):
    with pytest.raises(NodeEnded, match=f"^{re.escape(why)}$"):
        states(text).tick()


def test_delta_goes_to_and_fro_between_the_limits_and_round_where_there_are_none():
    made = states(robot(joint("a"), joint("b", kind="continuous")), delta=0.75)
    found = [made.tick().positions for _ in range(6)]
    assert [one[0] for one in found] == [0.75, 1, 0.25, -0.5, -1, -0.25]
    assert [one[1] for one in found[:5]] == [0.75, 1.5, 2.25, 3, -math.pi]


def test_delta_without_positions_and_a_source_whose_arrays_are_too_short_end_it():
    with pytest.raises(NodeEnded):
        states(robot(joint("a")), delta=0.1, publish_default_positions=False).tick()
    with pytest.raises(NodeEnded):
        states(WALKER).hear(Values(["tilt", "swivel"], [0.1]))


def test_dependences_are_read_by_joint():
    found = dependences({"b.parent": "a", "b.factor": 2.0, "c.parent": "b", "c.offset": 1.0})
    assert found == {"b": {"parent": "a", "factor": 2.0}, "c": {"parent": "b", "offset": 1.0}}


@pytest.mark.parametrize(
    ("parameters", "why"),
    [
        ({"b": "a"}, "Invalid dependent_joint name 'b'"),
        (
            {"b.mother": "a"},
            "Invalid dependent_joint name 'mother' (allowed values are 'parent', 'factor', "
            "'offset')",
        ),
        ({"b.factor": 1.0}, "All dependent_joints must at least have a parent"),
    ],
)
def test_dependences_that_are_none_are_refused_in_the_original_s_words(parameters, why):
    with pytest.raises(ValueError, match=f"^{re.escape(why)}$"):
        dependences(parameters)


def test_a_description_puts_an_end_to_the_dependences_of_parameters():
    made = JointStates(JointStateOptions(dependent_joints={"b": {"parent": "a"}}))
    assert made.tick() == Values([], [0.0], [], [])
    made.configure(robot(joint("a", 2, 4), joint("b")))
    assert made.tick().positions == [3, 0]
