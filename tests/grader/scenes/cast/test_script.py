"""Each mistake in a cast is told with its place and what is allowed there."""

from pathlib import Path

import pytest
import yaml

import grader
from grader.cli import main
from grader.errors import CheckFailed
from grader.exercise.known_types import KnownTypes, check_cast
from grader.scenes.cast import script
from grader.system.yaml_file import Mistake

STRING = "std_msgs/msg/String"
EXERCISE = """exercise: small
title: A small one
scene: {scene}
cast:
{cast}
limits: {{first_motion_s: 1, rest_s: 0, total_s: 2}}
expect:
{expect}
points: {{it: 1}}
"""


MISTAKES = yaml.safe_load(Path(__file__).with_name("mistakes.yaml").read_text(encoding="utf-8"))


def parsed(cast):
    return script.parse(yaml.safe_load(cast))


@pytest.mark.parametrize("mistake", MISTAKES["casts"], ids=lambda mistake: mistake["says"])
def test_a_mistake_in_a_cast_names_its_place_and_what_is_allowed(mistake):
    with pytest.raises(Mistake) as caught:
        parsed(mistake["cast"])
    said = str(caught.value)
    assert said.startswith(f"{mistake['at']}: ")
    assert mistake["says"] in said


def test_a_peer_may_have_nothing_and_names_are_its_topics():
    assert parsed("a:") == {"a": script.Peer()}
    (entry,) = parsed(f"a: {{publishers: {{x: {{type: {STRING}, rate: 2}}}}}}")[
        "a"
    ].publishers.values()
    assert (entry.topic, entry.types) == ("x", (STRING,))


@pytest.mark.parametrize(
    ("rate", "begin", "count", "times"),
    [(2, 0, 100, [0.5, 1.0, 1.5, 2.0]), (1, 0.25, 100, [0.25, 1.25]), (4, 1, 2, [1.0, 1.25])],
)
def test_a_publisher_begins_after_its_period_or_when_it_is_told(rate, begin, count, times):
    made = script.PeerPublisher(type=STRING, rate=rate, begin=begin, count=count)
    assert made.times(2.0) == times


def test_a_publisher_may_be_told_when_and_says_nothing_after_the_end():
    assert script.PeerPublisher(type=STRING, at=(3.0, 1.0, 9.0)).times(5.0) == [1.0, 3.0]


@pytest.mark.parametrize("peer", MISTAKES["peers"])
def test_what_a_peer_says_has_to_fit_its_type_and_the_run(peer):
    with pytest.raises(Mistake) as caught:
        check_cast(parsed(f"a: {{{peer}}}"), KnownTypes({}), 20, ("cast",))
    assert MISTAKES["peers"][peer] in str(caught.value)


FILES = MISTAKES["files"]


@pytest.mark.parametrize(
    ("file", "verb"),
    [*((file, "run") for file in FILES), (FILES[0], "check-exercise")],
    ids=lambda value: value if isinstance(value, str) else value["says"],
)
def test_a_mistake_in_a_file_is_told_with_its_line_and_ends_with_2(file, verb, tmp_path, capsys):
    expect_mistake(file, verb, tmp_path, capsys)


@pytest.mark.parametrize(
    "expect",
    [
        "  it: {topic: turtle1/pose}",
        "  it: {log: x, each: /turtle1/pose}",
        """  it: {topic: t, values: '=heard["/turtle1/pose"][-1].x'}""",
    ],
)
def test_a_topic_of_the_scene_is_none_that_a_cast_hears(expect, tmp_path, capsys):
    file = {"expect": expect, "cast": "  a: {}", "line": 8, "says": "turtle1/pose"}
    expect_mistake(file, "run", tmp_path, capsys, "turtlesim")


LISTENS = """import rclpy
from example_interfaces.srv import AddTwoInts
from std_msgs.msg import Int32

rclpy.init()
node = rclpy.create_node("listener")
node.create_subscription(Int32, "x", lambda message: None, 10)
node.create_client(AddTwoInts, "add").call_async(AddTwoInts.Request(a=9))
rclpy.spin(node)
"""


@pytest.mark.parametrize(
    ("expected", "peer", "why"),
    [
        (
            "topic: t",
            "publishers: {x: {type: std_msgs/msg/Int32, rate: 5, "
            """message: '=n if n < 2 else "a"'}}""",
            "Int32.data: The 'data' field must be of type 'int'",
        ),
        (
            "topic: t",
            "publishers: {x: {type: std_msgs/msg/Int32, rate: 5, message: '=1 // (2 - n)'}}",
            "integer division or modulo by zero",
        ),
        (
            "served: add, request: {a: 9}",
            "services: {add: {type: example_interfaces/srv/AddTwoInts, "
            """response: '=1 if a < 9 else "a"'}}""",
            "AddTwoInts_Response.sum: The 'sum' field must be of type 'int'",
        ),
    ],
)
def test_what_a_peer_turns_out_to_be_unable_to_say_is_the_exercise_s_fault(
    expected, peer, why, tmp_path
):
    cast, expect = f"  a: {{{peer}}}", f"  it: {{{expected}}}"
    path = tmp_path / "small" / "exercise.yaml"
    path.parent.mkdir()
    path.write_text(EXERCISE.format(cast=cast, expect=expect, scene="graph"))
    (tmp_path / "node.py").write_text(LISTENS)
    with pytest.raises(CheckFailed) as caught:
        grader.grade(tmp_path / "node.py", path.parent)
    assert (caught.value.exit_code, caught.value.whose) == (3, "exercise")
    assert "/a cannot say what the exercise asks of it" in str(caught.value)
    assert why in str(caught.value)


def expect_mistake(file, verb, tmp_path, capsys, scene="graph"):
    path = tmp_path / "small"
    path.mkdir()
    text = EXERCISE.format(cast=file["cast"], expect=file["expect"], scene=scene)
    (path / "exercise.yaml").write_text(text)
    (tmp_path / "node.py").write_text("import rclpy\n")
    words = [verb, str(tmp_path / "node.py"), "--exercise", str(path)]
    assert main(words if verb == "run" else [verb, str(path)]) == 2
    captured = capsys.readouterr()
    said = captured.out + captured.err
    assert f"exercise.yaml, line {file['line']}: " in said
    assert file["says"] in " ".join(said.split())
