"""Expressions are a fixed part of Python's syntax, and cost no more than they may."""

import math
import re

import pytest

from grader.system.expressions import (
    LONGEST_TEXT,
    MOST_STEPS,
    ExpressionError,
    check,
    filled,
    parse,
)

NAMES = {
    **{"n": 3, "text": "abc", "data": [1.5, 2.5], "pose": {"x": 1.0}, "zero": 0},
    **{"big": 2**63, "nan": math.nan, "many": list(range(20_000)), "long": "a" * 20_000},
    "heard": {"/data": [{"data": n} for n in range(9)]},
}


def value(text):
    return filled(f"={text}", NAMES)


def why(template, names=NAMES):
    with pytest.raises(ExpressionError) as caught:
        filled(template, names)
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        *(("n + 1", 4), ("7 // 2 - -1", 4), ("2 ** 3 % 5", 3), ("1 / 4", 0.25)),
        *(("pose.x", 1.0), ("data[-1]", 2.5), ("data[1:]", [2.5]), ("text[0]", "a")),
        *(("n if n > 2 else 0", 3), ("not n", False), ("n and 5 or 6", 5), ("1 < n <= 3", True)),
        *(("[x * 2 for x in data if x > 2]", [5.0]), ("max(data)", 2.5), ("len(text)", 3)),
        *(("mean(data)", 2.0), ("round(pi, 2)", 3.14), ("sorted([3, 1])", [1, 3])),
        *(("range(3)", [0, 1, 2]), ("str(n) + text", "3abc"), ("'b' in text", True)),
        *(("atan2(0, 1)", 0.0), ("hypot(3, 4)", 5.0), ("true", True), ("[1] * 3", [1, 1, 1])),
        ("mean([each.data for each in heard['/data'][-5:]])", 6.0),
    ],
)
def test_what_is_allowed_is_computed_as_python_does(text, expected):
    assert value(text) == expected


@pytest.mark.parametrize(
    "text",
    [
        *("lambda: 1", "n.__class__", "text._x", "f(1)", "text.upper()", "open('/etc/passwd')"),
        *("(1, 2)", "{1: 2}", "{1}", "1 << 3", "1 | 2", "n @ n", "~n", "n is n", "f'{n}'", "b'a'"),
        *("...", "None", "1j", "[*data]", "max(*data)", "round(1.5, ndigits=1)", "(n := 2)"),
        *("[x for x in data for y in data]", "{x for x in data}", "(x for x in data)", "await n"),
        "[x for x.y in [pose]]",
    ],
)
def test_everything_else_is_refused_when_it_is_read(text):
    with pytest.raises(ExpressionError, match=r"is not allowed in .* Allowed are numbers, texts"):
        parse(text)


@pytest.mark.parametrize("text", ["", "n +", "import os", "n = 2", "n\0", "(" * 300, "n n"])
def test_what_is_no_expression_is_refused_with_the_reason(text):
    with pytest.raises(ExpressionError, match="is no expression: "):
        parse(text)


def test_an_expression_is_not_longer_or_deeper_than_allowed():
    with pytest.raises(ExpressionError, match="at most 500 characters"):
        parse("1" * (LONGEST_TEXT + 1))
    for deep in (
        "-" * 400 + "1",
        "lambda:" + "-" * 400 + "1",
        "[" * 90 + "]" * 90,
        "1+" * 200 + "1",
    ):
        with pytest.raises(ExpressionError, match="levels"):
            parse(deep)


def test_the_names_of_an_expression_are_those_that_it_needs_from_outside():
    assert parse("max(a, pi) + b.c[d]").names == {"a", "b", "d"}
    assert parse("[x + y for x in data]").names == {"y", "data"}
    # a function is no value, and a name of a list ends with it
    assert parse("len").names == {"len"}
    assert parse("[x for x in data] + x").names == {"x", "data"}


@pytest.mark.parametrize("text", ["len()", "sqrt(1, 2)", "atan2(1)", "range()", "sum([], [])"])
def test_a_function_has_the_arguments_that_it_needs(text):
    with pytest.raises(ExpressionError, match="too many or too few arguments"):
        parse(text)


BOMBS = [
    *("9 ** 9 ** 9", "2 ** 256 * 2 ** 256", "n ** big", "'a' * 10 ** 9", "10 ** 9 * 'a'"),
    *("[0] * 10 ** 9", "data * data", "range(10 ** 9)", "range(-(10 ** 9), 0)", "long + text"),
    *("round(1, -(10 ** 9))", "round(1.5, big)", "[[0] * 20000] * 20000", "long * 2"),
    *("str([['a' * 20000] * 20000] * 20000)", "[many for x in many]", "str([many for x in many])"),
    *("[many[1:] for x in many]", "[long + '' for x in many]", "[x for x in many if many == many]"),
    *("[x for x in many if x in many]", "[[[1 for a in many] for b in many] for c in many]"),
    *("sorted([many for x in range(9)] * 9) == many", "[str(many) for x in many]"),
    "max([[y for y in many] for x in many])",
]


@pytest.mark.parametrize("text", BOMBS)
def test_a_bomb_is_refused_before_it_has_cost_much(text):
    assert re.search("at most|more than|too long|too great", why(f"={text}"))


def test_steps_are_counted_and_an_ordinary_expression_needs_few():
    assert value("mean([x * x for x in many[:1000]])") > 0
    assert f"more than {MOST_STEPS} steps" in why("=[[x for x in many] for y in many]")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        *(("n / zero", "division by zero"), ("text + n", "concatenate"), ("data[9]", "range")),
        *(("pose.y", "there is no field y"), ("n.x", "there is no field x"), ("m", "no value m")),
        *(("sqrt(-1)", "domain"), ("int(nan)", "NaN"), ("float(text)", "convert")),
        *(("mean([])", "zero"), ("max([])", "empty"), ("text * 1.5", "at most"), ("-text", "bad")),
        *(
            ("heard['/x'][0]", "no '/x' yet"),
            ("text % n", "filled in as"),
            ("n[0]", "subscriptable"),
        ),
        *(("text < n", "not supported"), ("exp(1000)", "range")),
    ],
)
def test_what_the_values_make_impossible_is_told(text, expected):
    assert expected in why(f"={text}")


def test_a_name_that_begins_with_a_line_is_no_way_out():
    for text in ("pose['__class__']", "[pose][0]['__init__']"):
        assert "__" in why(f"={text}")
    assert "there is no value __import__" in why("=__import__")


def test_a_text_is_filled_with_values_in_forms():
    found = filled("Hello {text}: {n}, {pose.x:.2f} {n:03d} {n:x}", NAMES)
    assert found == "Hello abc: 3, 1.00 003 3"
    assert filled({"a": ["=n", "{data[1:]}", 5]}, NAMES) == {"a": [3, "[2.5]", 5]}


@pytest.mark.parametrize("form", [">999999999", "999999999", ".999999999f", "^9", "*>9", "!r"])
def test_forms_that_make_long_texts_are_none(form):
    with pytest.raises(ExpressionError):
        check(f"{{n:{form}}}")


@pytest.mark.parametrize("hole", ["{data:d}", "{text:.2f}", "{big:c}", "{pose:x}", "{nan:d}"])
def test_a_form_that_does_not_fit_the_value_is_told(hole):
    assert "cannot be written" in why(hole)


def test_a_text_that_grows_too_long_is_refused():
    assert "too long" in why("{many}")


def test_what_repeats_in_a_pattern_is_no_hole():
    assert filled("/[0-9]{2} x{1,3} y{,2} {n}/", NAMES) == "/[0-9]{2} x{1,3} y{,2} 3/"


def test_a_value_within_a_pattern_stands_for_itself():
    found = filled("/^{text}{2}$/", {"text": ".*("}, has_patterns=True)
    assert found.search(".*((")
    assert not found.search("anything")


def test_what_an_expression_returns_is_no_pattern():
    assert filled("=text", {"text": "/.*/"}, has_patterns=True) == "/.*/"


@pytest.mark.parametrize("pattern", ["/(/", "/[/", "/a{2}{3}/", "/*/", "/x{99999999999}/"])
def test_a_pattern_that_is_none_is_refused_when_it_is_read(pattern):
    check(pattern)  # a peer may send such a text
    with pytest.raises(ExpressionError, match="is no pattern"):
        check(pattern, has_patterns=True)


def test_what_needs_no_value_is_computed_when_it_is_read():
    for wrong in ("=1 / 0", "{1 / 0}", "=[1][2]", "{[1]:d}"):
        with pytest.raises(ExpressionError):
            check(wrong)


def test_a_template_within_itself_or_with_very_many_values_is_refused():
    endless = []
    endless.append(endless)
    many = "x"
    for _ in range(40):
        many = [many, many]
    for template in (endless, {"a": many}):
        with pytest.raises(ExpressionError, match="at most 10000 values"):
            check(template)
