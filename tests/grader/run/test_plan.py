"""What is to be run comes to the simulator's process as it was meant."""

import json
from dataclasses import fields

import pytest

from grader.recording.subject import Start
from grader.run.handover import Plan
from grader.scenes.scene import Limits
from grader.text.message import Message, msg


def test_every_field_and_its_type_survive_the_way_to_another_process_as_one_line():
    plan = Plan(
        Limits(1.0, 2.0, 3.0),
        Start(0.0, 1 / 3, 5e-324),
        "moon",
        42,
        (msg("odd {n:.1f}", n=0.25), Message.of("ü\n")),
        "i",
        "s",
        True,
        ("robot_description",),
        {"demo/msg/Num": "int8 num\n"},
        {"peer": {"subscriptions": {"/topic": {"type": "std_msgs/msg/String"}}}},
        ("/topic",),
        {"own/msg/Num": "int8 num\n"},
        ("2", "3"),
        "late",
        {"a": 7},
    )
    usual = Plan(Limits(0.0, 0.0, 0.0))
    assert all(getattr(plan, f.name) != getattr(usual, f.name) for f in fields(Plan))
    text = plan.to_json()
    assert text.isascii() and text.isprintable()
    back = Plan.from_json(text)
    assert back == plan
    assert (type(back.limits), type(back.start), type(back.flags)) == (Limits, Start, tuple)


@pytest.mark.parametrize("text", ["", "{}", "[]", '{"limits": {}, "start": null, "flags": []}'])
def test_what_is_no_plan_is_no_plan(text):
    with pytest.raises((ValueError, KeyError, TypeError)):
        Plan.from_json(text)


def test_a_field_that_is_not_known_is_an_error():
    words = json.loads(Plan(Limits(1.0, 2.0, 3.0)).to_json()) | {"colour": "blue"}
    with pytest.raises(ValueError, match="colour"):
        Plan.from_json(json.dumps(words))
