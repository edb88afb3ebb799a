"""Values are compared as numbers, texts, lists and fields."""

import math
import re
from typing import Any

import pytest

from grader.exercise.comparing import LONGEST_MATCHED, SHOWN, differences, shown

INF, NAN = math.inf, math.nan


def said(found: Any, expected: Any, tolerance: float | None = None) -> list[str]:
    """What is told of each difference."""
    made = differences(found, expected, tolerance)
    return [f"{path}: {shown(value)}, {right!s}" for path, value, right in made]


@pytest.mark.parametrize(
    "values",
    [
        *((1, 1), (1.0, 1), (1, 1.0004), (0.0, 1e-7), (-5.0, -5.004), (2.0, 2.5, 0.5), (3, 2, 1)),
        *((True, True), ("a", "a"), ([], []), (INF, INF), (-INF, -INF, 0.1), (NAN, NAN)),
        *(("nan", NAN), ("-inf", -INF), (2**63, 2**63), ([1, 2.0], [1.0, 2]), ("/a/", "/a/")),
        *(({"a": 1, "b": 2}, {"a": 1}), ({"data": 5}, 5), ({"data": [1]}, [1]), ({"a": 1}, {})),
        *((5, {"at_least": 5}), (5, {"at_most": 5}), ({"data": 5}, {"at_least": 0})),
        *(("ab12", re.compile("[0-9]+$")), ({"x": {"y": 1}}, {"x": {"y": 1}})),
    ],
)
def test_these_are_equal(values):
    assert said(*values) == []


@pytest.mark.parametrize(
    ("words", "values"),
    [
        *((": 1, 2", (1, 2)), (": 1, 1.01", (1.0, 1.01)), (": 2, 2.6", (2.0, 2.6, 0.5))),
        *((": 1000000, 1000001", (1_000_000, 1_000_001)), (": 5, inf", (5.0, INF))),
        *((": inf, 5", (INF, 5.0, 1e9)), (": inf, -inf", (INF, -INF)), (": nan, 1", (NAN, 1))),
        *((": 1, nan", (1.0, NAN, INF)), (": 'inf', nan", ("inf", NAN)), (": True, 1", (True, 1))),
        *((": 1, True", (1, True)), (": False, 0", (False, 0)), (": '1', 1", ("1", 1))),
        *((": 1, '1'", (1, "1")), (": None, 0", (None, 0)), (": 'a', 'b'", ("a", "b"))),
        *((": 'a', '/a/'", ("a", "/a/")), (": [], 1 values: [0]", ([], [0]))),
        *(("[1]: 1, 2", ([0, 1], [0, 2])), (": '9 values', 1 values: [0]", ([0] * 9, [0]))),
        *((": 0, 1 values", (0, [0])), ("b: None, a field b", ({"a": 1}, {"b": 1}))),
        *(("b: None, a field", (3, {"b": 1})), ("x.y: 1, 2", ({"x": {"y": 1}}, {"x": {"y": 2}}))),
        *(("data: 5, 6", ({"data": 5}, 6)), (": 4, at least 5", (4, {"at_least": 5}))),
        *(("at most 5", (6, {"at_most": 5})), (": 6, 1 to 5", (6, {"at_least": 1, "at_most": 5}))),
        *(("nan", (NAN, {"at_least": 0})), (": 'x', at least 0", ("x", {"at_least": 0}))),
        *(("True", (True, {"at_least": 0})), ("at least 'a'", (1, {"at_least": "a"}))),
        *(("at most nan", (1, {"at_most": NAN})), ("what /5/", (5, re.compile("5")))),
        ("what /[0-9]/ fits", ("ab", re.compile("[0-9]"))),
    ],
)
def test_these_differ(words, values):
    (told,) = said(*values)
    assert words in told


def test_a_pattern_fits_no_text_that_takes_long_to_search():
    pattern = re.compile("a")
    assert said("a" * LONGEST_MATCHED, pattern) == []
    assert said("a" * (LONGEST_MATCHED + 1), pattern)


def test_a_value_in_a_sentence_is_short_and_holds_nothing_that_a_terminal_obeys():
    assert len(shown("x" * 2_000_000)) == SHOWN
    assert shown("\x1b[2J\udc80") == "'\\x1b[2J\\udc80'"
    assert shown(1 / 3) == "0.333333"
