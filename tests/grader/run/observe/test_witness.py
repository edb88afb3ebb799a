"""What is sent is counted by its line, in order, as long as that is short."""

import sys

import pytest

from grader.run.observe.files import SubmissionFiles
from grader.run.observe.witness import MOST_CHANGES, MOST_LINES, UsedEnd

FILES = SubmissionFiles("/")


@pytest.fixture
def end():
    return UsedEnd({"lines": [], "sent": []}, lambda: False)


def sent(end):
    return [(each["line"], each["times"]) for each in end.row["sent"]]


def test_equal_lines_in_a_row_are_one_entry(end):
    for _ in range(3):
        end.sent_from(sys._getframe(), FILES)
    end.sent_from(sys._getframe(), FILES)
    assert sent(end) == [(0, 3), (1, 1)]
    first, second = (place["line"] for place in end.row["lines"])
    assert second == first + 1


def test_after_what_was_sent_from_nowhere_nothing_is_counted(end):
    end.sent_from(sys._getframe(), FILES)
    end.sent_from(None, FILES)
    end.sent_from(sys._getframe(), FILES)
    assert sent(end) == [(0, 1)]


def test_it_stops_at_too_many_changes(end):
    for _ in range(MOST_CHANGES):
        end.sent_from(sys._getframe(), FILES)
        end.sent_from(sys._getframe(), FILES)
    assert len(end.row["sent"]) == MOST_CHANGES
    assert len(end.row["lines"]) == 2


def test_it_stops_at_too_many_lines(end):
    for number in range(MOST_LINES + 1):
        exec("\n" * number + "end.sent_from(sys._getframe(), FILES)")
    assert len(end.row["lines"]) == len(end.row["sent"]) == MOST_LINES
