"""Values are compared as numbers, texts, lists and fields."""

from __future__ import annotations

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
    ("found", "expected", "tolerance"),
    [
        *((1, 1, None), (1.0, 1, None), (1, 1.0004, None), (0.0, 1e-7, None), (-5.0, -5.004, None)),
        *((2.0, 2.5, 0.5), (3, 2, 1), (True, True, None), ("a", "a", None), ([], [], None)),
        *((INF, INF, None), (-INF, -INF, 0.1), (NAN, NAN, None), ("nan", NAN, None)),
        *(("-inf", -INF, None), (2**63, 2**63, None), ([1, 2.0], [1.0, 2], None)),
        *(({"a": 1, "b": 2}, {"a": 1}, None), ({"data": 5}, 5, None), ({"data": [1]}, [1], None)),
        *(
            (5, {"at_least": 5}, None),
            (5, {"at_most": 5}, None),
            ({"data": 5}, {"at_least": 0}, None),
        ),
        *(("ab12", re.compile("[0-9]+$"), None), ({"x": {"y": 1}}, {"x": {"y": 1}}, None)),
        *(({"a": 1}, {}, None), ("/a/", "/a/", None)),
    ],
)
def test_these_are_equal(found: Any, expected: Any, tolerance: float | None) -> None:
    assert said(found, expected, tolerance) == []


@pytest.mark.parametrize(
    ("found", "expected", "tolerance", "words"),
    [
        *((1, 2, None, ": 1, 2"), (1.0, 1.01, None, ": 1, 1.01"), (2.0, 2.6, 0.5, ": 2, 2.6")),
        *((1_000_000, 1_000_001, None, ": 1000000, 1000001"), (5.0, INF, None, ": 5, inf")),
        *(
            (INF, 5.0, 1e9, ": inf, 5"),
            (INF, -INF, None, ": inf, -inf"),
            (NAN, 1, None, ": nan, 1"),
        ),
        *((1.0, NAN, INF, ": 1, nan"), ("inf", NAN, None, ": 'inf', nan")),
        *(
            (True, 1, None, ": True, 1"),
            (1, True, None, ": 1, True"),
            (False, 0, None, ": False, 0"),
        ),
        *(("1", 1, None, ": '1', 1"), (1, "1", None, ": 1, '1'"), (None, 0, None, ": None, 0")),
        *(("a", "b", None, ": 'a', 'b'"), ("a", "/a/", None, ": 'a', '/a/'")),
        *(([], [0], None, ": [], 1 values: [0]"), ([0, 1], [0, 2], None, "[1]: 1, 2")),
        *(([0] * 9, [0], None, ": '9 values', 1 values: [0]"), (0, [0], None, ": 0, 1 values")),
        *(
            ({"a": 1}, {"b": 1}, None, "b: None, a field b"),
            (3, {"b": 1}, None, "b: None, a field"),
        ),
        *(
            ({"x": {"y": 1}}, {"x": {"y": 2}}, None, "x.y: 1, 2"),
            ({"data": 5}, 6, None, "data: 5, 6"),
        ),
        *((4, {"at_least": 5}, None, ": 4, at least 5"), (6, {"at_most": 5}, None, "at most 5")),
        *(
            (6, {"at_least": 1, "at_most": 5}, None, ": 6, 1 to 5"),
            (NAN, {"at_least": 0}, None, "nan"),
        ),
        *(("x", {"at_least": 0}, None, ": 'x', at least 0"), (True, {"at_least": 0}, None, "True")),
        *((1, {"at_least": "a"}, None, "at least 'a'"), (1, {"at_most": NAN}, None, "at most nan")),
        *(
            ("ab", re.compile("[0-9]"), None, "what /[0-9]/ fits"),
            (5, re.compile("5"), None, "what /5/"),
        ),
    ],
)
def test_these_differ(found: Any, expected: Any, tolerance: float | None, words: str) -> None:
    (told,) = said(found, expected, tolerance)
    assert words in told


def test_a_pattern_fits_no_text_that_takes_long_to_search() -> None:
    pattern = re.compile("a")
    assert said("a" * LONGEST_MATCHED, pattern) == []
    assert said("a" * (LONGEST_MATCHED + 1), pattern)


def test_a_value_in_a_sentence_is_short_and_holds_nothing_that_a_terminal_obeys() -> None:
    assert len(shown("x" * 2_000_000)) == SHOWN
    assert shown("\x1b[2J\udc80") == "'\\x1b[2J\\udc80'"
    assert shown(1 / 3) == "0.333333"
