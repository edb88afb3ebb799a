import json
import math

import pytest

from tests import golden_runs
from turtlesim_py.world import events
from turtlesim_py.world.events import CmdVel, EventError, RotateAbsolute, from_json, to_json


def test_every_recorded_event_comes_back_from_its_json():
    kinds = set()
    for name in golden_runs.NAMES:
        for words in golden_runs.load(name)["scenario"]["events"]:
            event = from_json(words)
            assert to_json(from_json(to_json(event))) == to_json(event)
            assert type(event) is events.KINDS[words["op"]]
            kinds.add(words["op"])
    assert kinds == set(events.KINDS)


def test_numbers_of_an_event_are_floats_and_texts_only_in_json():
    command = from_json(
        {"tick": 3, "op": "cmd_vel", "linear": ["nan", "-inf", 1], "angular": [0, 0, 0.5]}
    )
    assert isinstance(command, CmdVel)
    assert math.isnan(command.linear[0])
    assert command.linear[1:] == (-math.inf, 1.0)
    assert json.dumps(to_json(command)) == (
        '{"tick": 3, "op": "cmd_vel", "turtle": "turtle1", '
        '"linear": ["nan", "-inf", 1], "angular": [0, 0, 0.5]}'
    )


def test_a_goal_id_of_ros_is_hexadecimal_in_json():
    goal = RotateAbsolute(tick=1, theta=0.5, id=b"\x00\xff")
    assert to_json(goal)["id"] == "00ff"


@pytest.mark.parametrize(
    ("words", "complaint"),
    [
        ({"op": "clear"}, "'tick' must be a whole number, found None"),
        ({"tick": 1}, "unknown op None"),
        ({"tick": 1, "op": ["clear"]}, "unknown op"),
        ({"tick": 1, "op": "kill"}, "no field 'name'"),
        ({"tick": 1, "op": "kill", "name": 5}, "name: expected a text, found 5"),
        ({"tick": 1, "op": "cmd_vel", "linear": [1], "angular": [0] * 3}, "expected three numbers"),
        ({"tick": 1, "op": "teleport_relative", "linear": True, "angular": 0}, "expected a number"),
        (
            {"tick": 1, "op": "set_pen", "r": 1.5, "g": 0, "b": 0, "width": 1, "off": 0},
            "r: expected a whole number, found 1.5",
        ),
    ],
)
def test_json_that_is_no_event_is_told_what_is_wrong(words, complaint):
    with pytest.raises(EventError) as error:
        from_json(words)
    assert complaint in str(error.value)
