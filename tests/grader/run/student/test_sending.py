"""What is sent is counted by its line, in order, as long as that is short."""

from __future__ import annotations

import sys

from grader.run.student.sending import MOST_CHANGES, MOST_LINES, Sending


def test_equal_lines_in_a_row_are_one_entry():
    sending = Sending()
    for _ in range(3):
        sending.count(sys._getframe())
    sending.count(sys._getframe())
    assert sending.sent == [[0, 3], [1, 1]]
    first, second = (line for _, line in sending.lines)
    assert second == first + 1


def test_after_what_was_sent_from_nowhere_nothing_is_counted():
    sending = Sending()
    sending.count(sys._getframe())
    sending.count(None)
    sending.count(sys._getframe())
    assert sending.sent == [[0, 1]]


def test_it_stops_at_too_many_changes():
    sending = Sending()
    for _ in range(MOST_CHANGES):
        sending.count(sys._getframe())
        sending.count(sys._getframe())
    assert len(sending.sent) == MOST_CHANGES
    assert len(sending.lines) == 2


def test_it_stops_at_too_many_lines():
    sending = Sending()
    for number in range(MOST_LINES + 1):
        exec("\n" * number + "sending.count(sys._getframe())")
    assert len(sending.lines) == len(sending.sent) == MOST_LINES
