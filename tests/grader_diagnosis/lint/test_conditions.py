"""Where in the window a condition on the pose is true, as the source shows it."""

from pathlib import Path

import pytest
import yaml

from grader_diagnosis.lint import lint

HEAD = "LOW, HIGH = 1.0, 11.09 - 1.0\ndef on_pose(pose):\n"
CONDITIONS = yaml.safe_load(Path(__file__).with_name("conditions.yaml").read_text(encoding="utf-8"))


def found_in(source, kind):
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
