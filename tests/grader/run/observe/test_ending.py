"""Where a node goes no further."""

import sys
import threading

import pytest
import rclpy.executors

from grader.run.clock import rclpy_time
from grader.run.observe import ending
from grader.run.observe.files import Frame, SubmissionFiles


def test_a_thread_that_is_stuck_is_shown_without_our_frames():
    frames = sys._current_frames()[threading.get_ident()]
    thread = [Frame(str(rclpy_time.__file__), 1, "ours"), *SubmissionFiles("/").stack(frames)]
    text = ending.explain("callback", thread, 1.5)
    assert "Your node is stuck here, at 1.50 s" in text
    assert "in test_a_thread_that_is_stuck_is_shown_without_our_frames" in text
    assert "in ours" not in text
    assert "Do not wait in a callback" in text


def test_executors_that_refuse_a_spin_within_a_spin_do_not_any_more(monkeypatch):
    class Executor:
        _is_spinning = False

        def _enter_spin(self) -> None:
            if self._is_spinning:
                raise RuntimeError("Executor is already spinning")
            self._is_spinning = True

    monkeypatch.setattr(rclpy.executors, "Executor", Executor)
    rclpy_time.allow_nested_spins()
    spun = Executor()
    spun._enter_spin()
    spun._enter_spin()
    assert spun._is_spinning


NESTED = """\
def drive():
    for turn in range(4):
        while True:
            if turn:

    # a comment
                step(turn)
    return 1

x = 2
""".splitlines()


@pytest.mark.parametrize(("line", "found"), [(7, [3, 2]), (3, [3, 2]), (2, [2]), (8, []), (10, [])])
def test_the_loops_round_a_line_are_found_by_indentation(line, found):
    assert ending.loops_around(NESTED, line) == found


SPIN = Frame("/x/rclpy/executors.py", 9, "Executor.spin_once")
FOR_EVER = Frame("/x/rclpy/__init__.py", 9, "spin")
CALLBACK = Frame("/x/rclpy/task.py", 9, "Task.__call__")
SLEEP = Frame("/x/time.py", 9, "sleep")


def at(line: int, function: str = "drive") -> Frame:
    return Frame("/a/a.py", line, function, NESTED)


@pytest.mark.parametrize(
    ("frames", "found"),
    [
        ([SPIN, at(8)], None),
        ([SPIN, at(7)], None),
        ([SLEEP, at(7)], ("going", 3)),
        ([SLEEP, at(7), CALLBACK, SPIN, at(8)], ("going", 3)),
        ([SLEEP, at(8)], None),
        ([SPIN, at(8, "__init__"), at(10, "<module>")], ("init", 8)),
        ([SLEEP, at(8), at(7, "__init__")], ("init", 3)),
        ([FOR_EVER, at(7, "__init__")], ("init", 7)),
        ([FOR_EVER, at(7)], ("spin", 7)),
        ([FOR_EVER, at(8)], None),
        ([SLEEP], None),
    ],
)
def test_where_a_main_thread_is_at_the_end_is_told_unless_it_just_spins(frames, found):
    at = ending.standing(frames)
    assert (at and (at.kind, at.frame.line)) == found
