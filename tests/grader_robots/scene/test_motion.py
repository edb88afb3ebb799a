"""A listener of tf knows who hangs on whom; what is at odds in it is marked."""

import math

import pytest

from grader_robots.robot_py.robot_state import Placed
from grader_robots.scene import motion
from grader_robots.scene.driving import drive, tf
from grader_robots.scene.trace import TF_STATIC, RobotTrace
from tests.grader_robots.scene.robots import URDF, walks

STILL = (0.0, 0.0, 0.0, 1.0)


def says(parent: str, child: str, at=(0.0, 0.0, 0.0), turned=STILL, topic: str = "/tf"):
    """Whoever says so beside walking."""

    def controller(tick, now_ns):
        said = tf(Placed(now_ns, parent, child, at, turned), topic=topic)
        return (*walks(tick, now_ns), *([said] if tick % 2 == 0 else []))

    return controller


def tree(controller, ticks=200):
    made = motion.tree(drive(controller, ticks, URDF))
    assert made is not None
    return made


def told(controller):
    return [(n.depth, n.name, str(n.text), n.mark) for n in tree(controller).nodes]


def test_each_frame_says_who_sends_it_and_how_often():
    assert told(walks) == [
        (0, "odom", "hangs on nothing", ""),
        (1, "axis", "31.2 Hz, your node", ""),
        (2, "body", "15.6 Hz, robot_state_publisher", ""),
        (3, "head", "static, robot_state_publisher", ""),
    ]
    assert str(tree(walks).note) == "Every link of the robot has a place in odom."


def test_without_the_transform_from_odom_every_link_is_lost():
    made = tree(lambda tick, now_ns: walks(tick, now_ns)[:1])
    assert [node.mark for node in made.nodes] == ["lost"] * 3
    assert str(made.note).startswith("3 of 3 links of the robot have no place in odom")


def test_a_link_that_nobody_ever_sends_stands_alone():
    rows = told(lambda tick, now_ns: walks(tick, now_ns)[1:])
    assert (0, "body", "hangs on nothing", "lost") in rows
    assert (1, "head", "static, robot_state_publisher", "lost") in rows


def test_a_second_parent_is_told():
    by_name = {name: (text, mark) for _, name, text, mark in told(says("odom", "head"))}
    text, mark = by_name["head"]
    assert mark == "wrong"
    assert "parents: body, odom" in text and "robot_state_publisher and your node" in text


def test_a_circle_of_frames_has_an_end():
    def controller(tick, now_ns):
        placed = [Placed(now_ns, a, b, (0.0, 0.0, 0.0), STILL) for a, b in ("xy", "yx")]
        return (tf(*placed),)

    made = {n.name: n for n in tree(controller).nodes}
    assert "goes round in a circle" in str(made["y"].text)
    assert (made["y"].mark, made["x"].depth) == ("wrong", 1)


@pytest.mark.parametrize(
    ("parent", "child", "at", "turned"),
    [
        ("", "a", (0.0, 0.0, 0.0), STILL),
        ("a", "a", (0.0, 0.0, 0.0), STILL),
        ("a", "/a", (0.0, 0.0, 0.0), STILL),
        ("a", "b", (math.nan, 0.0, 0.0), STILL),
        ("a", "b", (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)),
    ],
)
def test_what_tf2_refuses_is_no_frame(parent, child, at, turned):
    assert told(says(parent, child, at, turned)) == told(walks)


def test_very_many_frames_are_counted_and_not_all_shown():
    def controller(tick, now_ns):
        return (tf(Placed(now_ns, "odom", f"frame{tick}", (0.0, 0.0, 0.0), STILL)),)

    made = tree(controller)
    assert len(made.nodes) == 150
    assert "54 more frames are not shown" in str(made.note)


def test_names_are_clipped_and_in_a_line():
    names = [name for _, name, *_ in told(says("odom", "a\n" + "b" * 200, topic=TF_STATIC))]
    assert max(map(len, names)) <= 60
    assert not any("\n" in name for name in names)


def test_nothing_heard_is_no_tree():
    assert motion.tree(RobotTrace(0)) is None
