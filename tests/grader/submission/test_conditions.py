"""Where in the window a condition on the pose is true, as the source shows it."""

from __future__ import annotations

import pytest

from grader.submission import lint

HEAD = "LOW, HIGH = 1.0, 11.09 - 1.0\ndef on_pose(pose):\n"
#: A function's body -> what is wrong with its first condition that tells a wall; None for no such.
CONDITIONS = {
    "if pose.x < 1 or pose.x > 10 or pose.y < 1 or pose.y > 10: stop()": "",
    "if not (LOW < pose.x < HIGH and LOW < pose.y < HIGH): stop()": "",
    "if LOW < pose.x < HIGH and LOW < pose.y < HIGH: drive()": "",
    "if min(pose.x, 11.09 - pose.x, pose.y, 11.09 - pose.y) < LOW: stop()": "",
    "walls = [pose.x, 11 - pose.x, pose.y, 11 - pose.y]\n    if min(walls) < 1: stop()": "",
    "if math.hypot(pose.x - 5.54, pose.y - 5.54) > 4.5: stop()": "",
    "if pose.x < 1: stop()\n    elif pose.x > 10 or pose.y < 1 or pose.y > 10: stop()": "",
    "sides = pose.x < 1 or pose.x > 10\n    if sides or pose.y < 1 or pose.y > 10: stop()": "",
    "if pose.x < 1 and pose.x > 10 and pose.y < 1 and pose.y > 10: stop()": "never",
    "if pose.x < 1 or pose.x < 10 or pose.y < 1 or pose.y > 10: stop()": "middle",
    "if pose.x > 1 or pose.x < 10: stop()": "always",
    "if (pose.x < 1 or pose.x > 10) and (pose.y < 1 or pose.y > 10): stop()": "corners",
    "if pose.x < 1 or pose.x > 10: stop()": "bottom, top",
    "if pose.x > 10: stop()": "left, bottom, top",
    "if pose.x > 12 or pose.y > 12 or pose.x < -1: stop()": "never",
    "if pose.x > 5.54 and pose.y > 5.54: paint()": None,
    "if pose.linear_velocity > 3: stop()": None,
    "if twist.linear.x > 3: stop()": None,
    "if LOW < HIGH: stop()": None,
    "if pose.x < margin(): stop()": None,
    "a = b + b\n    b = a * a\n    if pose.x < a: stop()": None,
    "if pose.x < 9 ** 9 ** 9 ** 9: stop()": None,
}


def found_in(source, kind):
    """Name and near of the findings of a kind."""
    files = {"a.py": source}
    found = lint.find(lint.parsed_of(files), files, lambda _: False)
    return [(name, near) for _, (of_kind, name, near, _) in found if of_kind == kind]


@pytest.mark.parametrize("body", CONDITIONS)
def test_a_condition_is_judged_by_where_it_is_true(body):
    found = [near for _, near in found_in(f"{HEAD}    {body}\n", "at_wall")]
    assert (found[0] if found else None) == CONDITIONS[body]


def test_a_condition_on_one_axis_alone_is_told_from_one_on_both():
    source = f"{HEAD}    n = 2 * int(pose.x > 5.54) + int(pose.x > 5.54)\n"
    ((name, _),) = found_in(source, "at_middle")
    assert name == "one axis"
    source = source.replace("+ int(pose.x", "+ int(pose.y")
    assert {name for name, _ in found_in(source, "at_middle")} == {"x", "y"}
