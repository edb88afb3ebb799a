"""robot_state_publisher without a node: what is published when, and what is said."""

import math
from pathlib import Path

import pytest

from grader_robots.robot_py import robot_state
from grader_robots.robot_py.robot_state import (
    JointState,
    NodeLog,
    Parameters,
    RefusedDescription,
    Robot,
    RobotState,
)
from tests.grader_robots.robot_py import urdf_cases as cases

ROBOTS = Path(__file__).parent / "robots"
WALKER = Robot.of((ROBOTS / "walker.urdf").read_text())
ROVER = Robot.of((ROBOTS / "rover.urdf").read_text())
ALL = ("tilt", "swivel", "periscope")
SECOND = 1_000_000_000
START = 1_700_000_000 * SECOND
INVALID = "Robot state publisher ignored an invalid JointState message"


def at(stamp_ns: int, *names: str, position: float = 0.1) -> JointState:
    return JointState(stamp_ns, names or ALL, [position] * len(names or ALL))


def published(state: RobotState, stamps: list[int], now_ns: int | None = None) -> list[int]:
    """The stamps that go to /tf, where each message arrives as it is stamped, or at one time."""
    heard = [(stamp, state.hear(at(stamp), now_ns or stamp)) for stamp in stamps]
    return [stamp for stamp, answer in heard if answer.transforms is not None]


def rate(hertz: int, parameters: Parameters) -> float:
    """Messages a second on /tf, from 10 s of joint states at that rate."""
    stamps = [START + number * SECOND // hertz for number in range(10 * hertz)]
    return len(published(RobotState(WALKER, parameters), stamps)) / 10


@pytest.mark.parametrize(
    ("hertz", "expected"),
    [(5, 5), (10, 10), (20, 20), (25, 12.5), (30, 15), (50, 16.7), (60, 20), (100, 20)],
)
def test_so_many_messages_go_on_to_tf(hertz, expected):
    assert rate(hertz, Parameters()) == pytest.approx(expected, abs=0.1)


@pytest.mark.parametrize("frequency", [30.0, 60.0, 1000.0, 0.0])
def test_30_hz_all_pass_where_the_frequency_is_at_least_that_or_0(frequency):
    assert rate(30, Parameters(publish_frequency=frequency)) == 30


def test_the_interval_is_of_whole_milliseconds():
    assert Parameters(publish_frequency=30.0).interval_ns == 33_000_000
    assert Parameters(publish_frequency=1000.0).interval_ns == 1_000_000


def test_a_stamp_that_stays_is_published_once_and_0_never():
    for stamp, passed in ((START, [True, False, False]), (0, [False, False, False])):
        state = RobotState(WALKER)
        heard = [state.hear(at(stamp), START + now * SECOND) for now in range(3)]
        assert [one.transforms is not None for one in heard] == passed


def test_whatever_its_stamp_a_message_passes_where_stamps_are_ignored():
    state = RobotState(WALKER, Parameters(ignore_timestamp=True))
    assert published(state, [0, 0, 5, 1], START) == [0, 0, 5, 1]


def test_stamps_in_the_future_pass_and_so_do_all_while_the_time_is_not_known():
    future = [START + number for number in range(4)]
    assert published(RobotState(WALKER), future, now_ns=SECOND) == future
    state = RobotState(WALKER)
    assert all(state.hear(at(stamp), 0).transforms is not None for stamp in future)


def test_the_joint_that_was_published_longest_ago_decides():
    state = RobotState(WALKER)
    millisecond = SECOND // 1000
    assert state.hear(at(START, "tilt"), START).transforms
    both = at(START + millisecond, "tilt", "swivel")
    assert state.hear(both, START + millisecond).transforms
    again = at(START + 2 * millisecond, "tilt", "swivel")
    assert state.hear(again, START + 2 * millisecond).transforms is None


def test_transforms_come_by_the_alphabet_of_the_joints_with_the_message_s_stamp():
    state = RobotState(WALKER, Parameters(frame_prefix="one/"))
    transforms = state.hear(at(START + 5), START + 99).transforms
    assert [(one.frame, one.child_frame) for one in transforms] == [
        ("one/head", "one/rod"),
        ("one/body", "one/head"),
        ("one/axis", "one/body"),
    ]
    assert {one.stamp_ns for one in transforms} == {START + 5}
    assert transforms[0].translation == pytest.approx(
        (0.13, 0.08 - 0.1 * math.sin(0.1), 0.16 + 0.1 * math.cos(0.1))
    )


def test_only_joints_that_are_named_are_sent_and_names_of_no_joint_are_nothing():
    state = RobotState(WALKER)
    transforms = state.hear(at(START, "head", "swivel", "leg1connect"), START).transforms
    assert [one.child_frame for one in transforms] == ["head"]


def test_of_a_joint_that_is_named_twice_the_first_counts():
    state = JointState(START, ("periscope", "periscope"), (0.1, 0.2))
    (transform,) = RobotState(WALKER).hear(state, START).transforms
    assert math.dist(transform.translation, (0.13, 0.08, 0.16)) == pytest.approx(0.1)


def test_limits_are_not_applied():
    transform = RobotState(WALKER).hear(at(START, "periscope", position=9.0), START).transforms[0]
    assert math.dist(transform.translation, (0.13, 0.08, 0.16)) == pytest.approx(9)


def test_a_position_that_is_no_number_is_published():
    state = JointState(START, ("tilt",), (math.nan,))
    (transform,) = RobotState(WALKER).hear(state, START).transforms
    assert all(map(math.isnan, transform.rotation))


def test_a_finger_that_follows_is_published_with_the_one_that_leads():
    state = RobotState(ROVER)
    transforms = state.hear(at(START, "left_finger_joint", position=0.02), START).transforms
    assert [one.child_frame for one in transforms] == ["left_finger", "right_finger"]
    assert transforms[1].translation[0] == pytest.approx(-0.03 - 0.02)
    assert state.hear(at(START + SECOND, "lift"), START).transforms[0].child_frame == "mast"


@pytest.mark.parametrize(
    ("names", "positions", "severity", "text"),
    [
        (
            *(("tilt", "swivel"), (), "WARN"),
            "Robot state publisher ignored a JointState message about joint(s) "
            '"tilt"(,...) whose position member was empty.',
        ),
        (("tilt", "swivel"), (1.0,), "ERROR", INVALID),
        ((), (1.0,), "ERROR", INVALID),
    ],
)
def test_names_and_positions_that_do_not_match_are_ignored_aloud(names, positions, severity, text):
    heard = RobotState(WALKER).hear(JointState(START, names, positions), START)
    assert heard == robot_state.Published(None, (NodeLog(severity, text),))


def test_a_negative_stamp_is_ignored_aloud():
    heard = RobotState(WALKER).hear(at(-1), START)
    text = "cannot store a negative time point in rclcpp::Time"
    assert heard == robot_state.Published(None, (NodeLog("ERROR", text),))


def test_a_clock_that_goes_back_is_warned_of_and_all_is_published_anew():
    state = RobotState(WALKER)
    assert state.hear(at(START), START).transforms is not None
    earlier = START - 10 * SECOND
    heard = state.hear(at(earlier), earlier)
    warning = NodeLog("WARN", "Moved backwards in time, re-publishing joint transforms!")
    assert heard.logs == (warning,)
    assert heard.transforms is not None


def test_fixed_joints_come_by_the_alphabet_of_their_names():
    fixed = WALKER.fixed("p/", 7)
    assert [one.child_frame for one in fixed] == ["p/box", "p/leg1", "p/leg2"]
    assert {one.stamp_ns for one in fixed} == {7}
    assert fixed[1].translation == (0, 0.31, 0)


def test_another_robot_and_other_parameters_act_at_once():
    state = RobotState(WALKER)
    state.set_robot(ROVER)
    state.parameters = Parameters(frame_prefix="r_")
    (transform,) = state.hear(at(START, "lift", "tilt"), START).transforms
    assert (transform.frame, transform.child_frame) == ("r_base_link", "r_mast")


def test_a_description_that_urdfdom_refuses_is_refused_with_what_urdfdom_says():
    with pytest.raises(RefusedDescription) as caught:
        Robot.of("<robot/>")
    assert str(caught.value) == "Unable to initialize urdf::model from robot description"
    assert [str(found) for found in caught.value.findings] == [
        "Error:   No name given for the robot."
    ]


def test_links_in_a_circle_are_refused():
    circle = '<joint name="k" type="fixed"><parent link="b"/><child link="b"/></joint>'
    with pytest.raises(RefusedDescription) as caught:
        Robot.of(cases.joint(cases.PARENT_AND_CHILD).replace("</robot>", f"{circle}</robot>"))
    assert str(caught.value) == "Failed to extract kdl tree from robot description"


def test_a_root_that_weighs_something_is_warned_of():
    assert WALKER.logs == (
        NodeLog(
            "WARN",
            "The root link axis has an inertia specified in the URDF, but KDL does not support a "
            "root link with an inertia.  As a workaround, you can add an extra dummy link to your "
            "URDF.",
            "kdl_parser",
        ),
    )
    assert ROVER.logs == ()


@pytest.mark.parametrize(("kind", "frames"), [("planar", ["b"]), ("floating", [])])
def test_planar_joints_are_sent_as_fixed_and_floating_ones_not_at_all(kind, frames):
    robot = Robot.of(cases.moving("", kind))
    text = "Converting unknown joint type of joint 'j' into a fixed joint"
    assert robot.logs == (NodeLog("WARN", text, "kdl_parser"),)
    assert [one.child_frame for one in robot.fixed("", 0)] == frames
    assert RobotState(robot).hear(at(START, "j"), START).transforms == ()


@pytest.mark.parametrize(
    ("hertz", "usable"), [(0.0, True), (1000.0, True), (-0.1, False), (1000.1, False)]
)
def test_a_frequency_is_from_0_to_1000(hertz, usable):
    assert robot_state.is_usable_frequency(hertz) == usable
