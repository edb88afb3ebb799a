"""The last error is found in what a node has printed."""

from dataclasses import replace

import pytest

from grader.exercise.sentences import how_it_ended, remarks
from grader.recording.observations import Observations, Raised, SourceLine
from grader.recording.recording import Run
from tests.grader.driving import drive

CRASH = """[INFO] hello
Traceback (most recent call last):
  File "/tmp/x/turtle_controller.py", line 3, in <module>
    import turtlesim_messages
ModuleNotFoundError: No module named 'turtlesim_messages'
"""
SYNTAX = """  File "/tmp/x/turtle_controller.py", line 12
    def drive(self)
                   ^
SyntaxError: expected ':'
"""


@pytest.mark.parametrize(
    ("output", "expected"),
    [
        (
            CRASH,
            "ModuleNotFoundError: No module named 'turtlesim_messages' "
            "(turtle_controller.py, line 3)",
        ),
        (SYNTAX, "SyntaxError: expected ':' (turtle_controller.py, line 12)"),
        (
            CRASH.replace("ModuleNotFoundError: No module", "my_pkg.errors.Oops: no module"),
            "my_pkg",
        ),
        ("no error at all\n", ""),
        ("", ""),
    ],
)
def test_the_last_error_is_found_with_file_and_line(output, expected):
    said = str(how_it_ended(crashed(output, None)))
    assert said.startswith(f" The node ended with an error: {expected or 'exit code 1.'}")


IN_A_LIBRARY = CRASH.replace("<module>", "spin").replace("turtle_controller", "executors")


def crashed(output, raised):
    run = Run(outcome="crashed", exit_code=1)
    recording = drive(lambda tick, pose, arena: None, ticks=1)
    seen = Observations(True, raised=raised)
    return replace(recording, run=run, output=output, observations=seen)


@pytest.mark.parametrize(
    ("output", "type_", "expected"),
    [
        (
            IN_A_LIBRARY,
            "ModuleNotFoundError",
            "ModuleNotFoundError: No module named 'turtlesim_messages' (drive.py, line 39)",
        ),
        ("", "KeyError", "KeyError: 'x' (drive.py, line 39)"),
        (
            IN_A_LIBRARY,
            "KeyError",  # that ended a thread, and something else the program
            "ModuleNotFoundError: No module named 'turtlesim_messages' (executors.py, line 3)",
        ),
    ],
)
def test_an_error_names_the_last_line_of_the_submission_s_own(output, type_, expected):
    recording = crashed(output, Raised(type_, "'x'", 1.0, SourceLine("src/drive.py", 39)))
    assert str(how_it_ended(recording)) == f" The node ended with an error: {expected}."


def test_an_error_that_cost_nothing_and_a_signal_are_told_as_such():
    recording = crashed(CRASH, None)
    assert str(remarks(recording, all_passed=True)[0]) == (
        "After its work was done the node ended with an error: ModuleNotFoundError: No module "
        "named 'turtlesim_messages' (turtle_controller.py, line 3); it costs no points."
    )
    assert str(remarks(recording)[0]).startswith("The node ended with an error: ")
    run = Run(outcome="killed", exit_code=-9)
    recording = drive(lambda tick, pose, arena: None, ticks=1)
    assert str(how_it_ended(replace(recording, run=run))).endswith("killed (signal 9).")
    run = Run(outcome="killed", exit_code=None)
    assert str(how_it_ended(replace(recording, run=run))).endswith("was killed.")
