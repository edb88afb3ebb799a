"""Which lines of a submission run, and what its conditions are asked about."""

from __future__ import annotations

import runpy
import sys

import pytest

from grader.run.observe import lines
from grader.run.observe.files import SubmissionFiles
from grader.run.observe.lines import LineTrace

PROGRAM = """\
from enum import Enum
State = Enum("State", "IDLE GOING")

class Node:
    def __init__(self):
        self.state = State.IDLE
        self.x = 1.23456

    def tick(self, most=3):
        if self.state == "GOING" and self.x > most:
            self.go()
        try:
            self.lost()
        except AttributeError:
            pass

node = Node()
for _ in range(3):
    node.tick()
"""


@pytest.fixture
def trace(tmp_path):
    before = sys.gettrace()
    yield LineTrace(SubmissionFiles(str(tmp_path)))
    sys.settrace(before)


def run(trace, tmp_path, program=PROGRAM):
    file = tmp_path / "drive.py"
    file.write_text(program)
    trace.within(runpy.run_path, str(file))
    return {row["file"]: row for row in trace.rows()}


def test_the_lines_that_run_are_known_and_no_others(trace, tmp_path):
    (row,) = run(trace, tmp_path).values()
    assert set(range(1, 20)) - set(row["lines"]) <= {3, 4, 8, 11, 16}
    assert 11 not in row["lines"]


def test_a_conditions_names_are_shown_with_what_they_stood_for(trace, tmp_path):
    (row,) = run(trace, tmp_path).values()
    (asked,) = row["asked"]
    assert asked == {"line": 10, "text": "self.state = State.IDLE, self.x = 1.235, most = 3"}


def test_an_exception_that_the_program_catches_is_known_with_its_line(trace, tmp_path):
    (row,) = run(trace, tmp_path).values()
    (raised,) = row["raised"]
    assert raised["line"] == 13
    assert raised["text"] == "AttributeError: 'Node' object has no attribute 'lost'"


def test_a_value_is_looked_up_without_running_anything_of_the_program(trace, tmp_path):
    program = """\
class Odd:
    @property
    def x(self):
        raise SystemExit("was run")
    def __repr__(self):
        raise SystemExit("was run")
    __getattr__ = __str__ = __format__ = __repr__

class Wrong(AttributeError):
    __str__ = Odd.__repr__

odd = Odd()
def tick(odd):
    if odd is odd.__class__ or odd is None:
        pass
    try:
        raise Wrong()
    except AttributeError:
        pass
    return 1 if 0 else 2
tick(odd)
"""
    (row,) = run(trace, tmp_path, program).values()
    assert [at["text"] for at in row["asked"]] in ([], [""])
    assert row["raised"] == []


def test_what_spins_is_not_followed_and_its_callbacks_are(trace, tmp_path):
    file = tmp_path / "drive.py"
    file.write_text("def spin(call):\n    call()\n\ndef tick():\n    return 1\n")
    program = runpy.run_path(str(file))
    trace.within(lines.unfollowed, program["spin"], lambda: trace.within(program["tick"]))
    (row,) = trace.rows()
    assert row["lines"] == [4, 5] or row["lines"] == [5]


def test_after_very_many_lines_nothing_is_known(trace, tmp_path, monkeypatch):
    monkeypatch.setattr(lines, "MOST_LINES", 20)
    assert run(trace, tmp_path) == {}
