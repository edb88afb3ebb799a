"""Why a call was never reached: from the source, and the lines that have run."""

import ast

import pytest

from grader.recording.observations import LineText, LintFinding, RanFile, SourceLine
from grader_diagnosis.lint import paths
from grader_diagnosis.lint.scopes import Source

NODE = """\
class Drive(Node):
    def __init__(self):
        self.state = 0

    def on_timer(self):
        if self.state == 0:
            return
        self.drive()

    def drive(self):
        self.pub.publish(Twist())

    def on_pose(self, pose):
        if pose.x > 20:
            self.state = 1
        elif pose.x > 10:
            self.pen.call_async(request)
        else:
            self.pub.publish(Twist())

def main():
    node = Drive()
    rclpy.spin(node)
    node.pub.publish(Twist())
"""
BEGUN = {1, 2, 3, 5, 10, 13, 22, 23, 24}


def missed(ran, asked=(), source=NODE):
    """What was not reached: goal, how, values; the code; the line."""
    steps = [
        LintFinding(kind, name, near, SourceLine("a.py", line))
        for kind, name, near, line in paths.find(Source(ast.parse(source)))
    ]
    file = RanFile("a.py", tuple(sorted(ran)), tuple(asked), ())
    return [(each.near, each.name, each.place.line) for each in paths.unreached(steps, [file])]


def test_a_condition_that_is_never_true_is_why_and_is_shown_with_its_values():
    ran = BEGUN | {6, 7, 14, 16, 19}
    asked = [LineText(16, "pose.x = 5.54")]
    assert ("call_async true pose.x = 5.54", "pose.x > 10", 16) in missed(ran, asked)


def test_what_should_have_set_the_condition_comes_before_the_condition():
    found = missed(BEGUN | {6, 7, 14, 16, 19})
    lines = [line for near, _, line in found if near.startswith("publish")]
    assert lines[:2] == [14, 6]


def test_a_condition_that_is_always_true_and_leaves_the_function_is_why():
    source = "def go():\n    if late:\n        return\n    pub.publish(x)\n"
    assert missed({1, 2, 3}, source=source) == [("publish false", "late", 2)]


def test_a_function_that_nothing_calls_is_why():
    assert missed({1}, source="def go():\n    pub.publish(x)\n") == [("publish called", "go", 1)]


def test_a_line_that_does_not_come_to_its_end_is_why():
    found = missed(BEGUN - {24} | {6, 8, 11, 14, 15, 17, 19})
    assert ("publish past", "rclpy.spin(node)", 23) in found


def test_what_was_reached_is_not_missed():
    assert missed(BEGUN | {6, 7, 8, 11, 14, 15, 16, 17, 19, 24}) == []


def test_of_a_file_that_was_not_followed_nothing_is_known():
    assert missed(()) == []


@pytest.mark.parametrize("near", ["", "publish", "publish x true 1 2", "publish 1 true 1 2 3"])
def test_a_step_of_another_form_is_refused(near):
    wrong = LintFinding("step", "a", near, SourceLine("a.py", 1))
    with pytest.raises((ValueError, TypeError)):
        list(paths.unreached([wrong], []))
