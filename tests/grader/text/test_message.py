"""A message is a key with values: English as a text, JSON between processes and in files."""

import json
import pickle
from copy import deepcopy
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from grader.errors import SubmissionError, UsageError
from grader.exercise.result import json_file
from grader.text.message import (
    NOTHING,
    Message,
    authored,
    chained,
    fill,
    in_context,
    joined,
    msg,
    series,
)
from grader.text.strings import clip, one_line


def test_as_a_text_it_is_english_with_its_values():
    made = msg("It made {turns:.1f} turns in {file}.", turns=2.53, file="drive.py")
    assert str(made) == "It made 2.5 turns in drive.py."
    assert (made.key, made.values["turns"]) == ("It made {turns:.1f} turns in {file}.", 2.53)


@pytest.mark.parametrize("lost", ["{}", "{:>20}"])
def test_it_is_no_text_and_does_not_become_one_unseen(lost):
    made = msg("It made {turns:.1f} turns.", turns=2.53)
    assert not isinstance(made, str)
    assert made != "It made 2.5 turns."
    with pytest.raises(TypeError, match="a message within a text is lost; render or join it"):
        lost.format(made)
    with pytest.raises(TypeError):
        "a" + made
    with pytest.raises(TypeError, match="a message in a page is lost; render it: 'red'"):
        msg("red").__html__()


@pytest.mark.parametrize(
    ("n", "said"), [(0, "0 pins"), (1, "1 pin"), (2, "2 pins"), (4210, "4,210 pins")]
)
def test_one_and_many(n, said):
    assert str(msg("{n:,} pin", "{n:,} pins", n=n)) == said


def test_a_row_has_its_parts_and_those_of_rows_in_it():
    row = joined([msg("one"), "2", joined([msg("three"), "4"])], " ")
    assert str(row) == "one 2 three4"
    assert list(row.values.values()) == [msg("one"), " ", "2", " ", msg("three"), "4"]
    assert row.is_row
    assert not msg("{p0} of it", p0="x").is_row
    assert joined([msg("one")], ", ") == msg("one")
    assert joined(["one"]) == Message.of("one")
    assert joined([]) == NOTHING
    assert str(joined([msg("one"), NOTHING, ""])) == "one"


@pytest.mark.parametrize(
    ("items", "said"),
    [([], ""), (["a"], "a"), (["a", "b"], "a and b"), (["a", "b", "c"], "a, b and c")],
)
def test_some_things_in_one_row(items, said):
    assert str(series(items)) == said
    assert str(series(map(msg, items))) == said
    assert str(chained(items)) == said.replace(",", " and")


@pytest.mark.parametrize(
    "key",
    ["{none}", "{0}", "{}", "{a.real}", "{a[0]}", "{a:{a}}", "{a:999999}", "{a:.999f}", "{a", "a}"],
)
def test_a_key_asks_for_its_values_and_nothing_else(key):
    with pytest.raises(ValueError, match=r"no value for|expected|Single|encountered"):
        fill(key, {"a": 1})


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        *(("{it!r}", "a'b", '"a\'b"'), ("{it!r}", msg("red"), "'red'"), ("{it!r}", 1.5, "1.5")),
        *(("{it!u}.", msg("the sun"), "The sun."), ("{it!u}.", msg("a.py is"), "a.py is.")),
        *(("{it}.", Path("a/b"), "a/b."), ("{it}.", None, "None.")),
    ],
)
def test_a_value_may_be_quoted_or_begin_a_sentence_and_be_anything_that_has_a_text(
    key, value, said
):
    assert str(msg(key, it=value)) == said


def test_nothing_is_said_by_none_and_a_plain_text_is_itself():
    empty = Message("{text}", {"text": ""})
    for nothing in (NOTHING, Message.of(""), Message.of(""), msg(""), joined([]), empty):
        assert not nothing
        assert str(nothing) == ""
    assert Message.of("x")
    assert msg("{it}", it=NOTHING)  # it is a sentence
    made = Message.of("{0} is 5 % of {")
    assert (str(made), made.text) == ("{0} is 5 % of {", "{0} is 5 % of {")
    assert (msg("text").text, msg("{text}", text=1).text) == (None, None)
    assert Message.of(made) is made
    assert Message.of("x") == Message.of("x")


def test_what_an_author_has_written_has_no_values_and_a_word_may_have_a_context():
    made = authored("Draw a {square}.").translated("fr", "Dessinez un {carré}.")
    assert str(made) == "Draw a {square}."
    assert made.words == {"fr": "Dessinez un {carré}."}
    left = in_context("left", "of a wall")
    assert (str(left), left.key) == ("left", "left (of a wall)")


def test_it_lives_through_copies_and_processes_and_values_are_given_later():
    made = msg("{where}: {note}", where="a", note=msg("{n} pin", "{n} pins", n=2))
    for other in (deepcopy(made), pickle.loads(pickle.dumps(made))):
        assert other == made
        assert hash(other) == hash(made)
    half = msg("{where}: {note}", where="a")
    assert str(half.given(note=Path("b/c"))) == "a: b/c"
    deep = msg("{a} {b} {n}", a=" x  y ", b=msg("by {who}", who="me\nyou"), n=3)
    assert str(deep.map_texts(one_line)) == "x y by me you 3"
    assert str(deep.map_texts(partial(clip, limit=2))) == " … by m… 3"
    assert str(deep) == " x  y  by me\nyou 3"


def test_an_exception_keeps_its_message_and_else_says_all():
    made = msg("is damaged")
    assert Message.of(ValueError(made)) is made
    assert (str(Message.of(ValueError())), str(Message.of(ValueError("a", 1)))) == ("", "('a', 1)")
    odd = UnicodeDecodeError("utf-8", b"\xff", 0, 1, "invalid start byte")
    assert str(Message.of(odd)).endswith("invalid start byte")
    made = msg("{where}: {note}", where="a", note="b")
    assert SubmissionError(made).message == made
    assert UsageError("as it is").message == Message.of("as it is")
    made = msg("{where}: {note}", where="a\x1b[2J", note=msg("says {it}", it="b\nc\x07"))
    assert str(SubmissionError(made)) == "a?[2J: says b\nc?"


@pytest.mark.parametrize("error", [ValueError(), ValueError("a", 1)])
def test_a_file_that_cannot_be_used_is_told_whatever_its_reader_raises(error):
    def make(data):
        raise error

    with pytest.raises(UsageError, match=r"result\.json "):
        json_file.made(make, Path("result.json"), {})


SAID = [
    NOTHING,
    Message.of("plain {"),
    msg("It made {turns:.1f} turns, {why}", turns=2.5, why=msg("of {asked}.", asked=msg("three"))),
    joined([msg("one"), " 2"]),
    msg("{n} pin", "{n} pins", n=3),
    authored("Drive {on}").translated("zh", "前进"),
    in_context("left", "of a wall"),
    msg("{is_so} at {where}", is_so=True, where=Message.of("{home}")),
]


@pytest.mark.parametrize("said", SAID, ids=str)
def test_from_json_it_comes_back_as_it_was(said):
    back = Message.parse(json.loads(json.dumps(said.serialise(), allow_nan=False)))
    assert back == said
    assert (str(back), bool(back)) == (str(said), bool(said))


def test_a_text_is_a_text_in_json_and_a_sentence_has_what_it_is_made_of():
    assert Message.of("x").serialise() == "x"
    assert msg("x").serialise() == {"key": "x"}
    assert msg("{n} pin", "{n} pins", n=3).serialise() == {
        "key": "{n} pin",
        "values": {"n": 3},
        "many": "{n} pins",
    }
    said = msg("{a} {b} {c} {d}", a=np.float64(1.5), b=np.int64(2), c=float("nan"), d=Path("x"))
    assert said.values == {"a": 1.5, "b": 2, "c": "nan", "d": "x"}
    assert list(map(type, said.values.values())) == [float, int, str, str]
    json.dumps(said.serialise(), allow_nan=False)


def rows(levels):
    return [rows(levels - 1)] if levels else []


def deep(levels):
    data = {"key": "x"}
    for _ in range(levels):
        data = {"key": "{a}", "values": {"a": data}}
    return data


NO_MESSAGES = [
    *(None, 1, [], {}, {"key": 1}, {"key": "x", "many": 2}, {"values": {}}, {"parts": ["a"]}),
    *({"key": "x", "parts": []}, {"key": "x", "code": "1"}, {"key": "x", "values": [1]}),
    *({"key": "x", "words": ["x"]}, {"key": "x", "words": {"a": 1}}),
    *({"key": "{a}", "values": {"a": value}} for value in (None, [1], True, {"text": "x"})),
    *(deep(13), deep(500), {"key": "x", "values": {"a": rows(900)}}),
]
UNFIT = [
    {"key": "at {time_s:.2f} s, at {place}"},
    *({"key": key, "values": {"a": 1}} for key in ("{a:99999999999}", "{a.__class__}", "{a:{a}}")),
    *({"key": key, "values": {"a": "x"}} for key in ("{a[0]}", "{a!r:>9999}", "{")),
    *({"key": "{a:d}", "values": {"a": 1.5}}, {"key": "{a:.1f}", "values": {"a": 10**400}}),
    *(
        {"key": "{n:,} call", "many": "{n:,} calls"},
        {"key": "{a}", "values": {"a": {"key": "{b}"}}},
    ),
    {"key": "{n} call", "many": "{more} calls", "values": {"n": 2}},
]


@pytest.mark.parametrize(
    ("data", "said"),
    [
        *((data, r"^expected ") for data in NO_MESSAGES),
        *((data, r"^expected values that fit a message's key: ") for data in UNFIT),
    ],
)
def test_json_that_is_no_message_is_refused(data, said):
    with pytest.raises(ValueError, match=said):
        Message.parse(data)


def test_whoever_reads_holds_each_text_against_bounds():
    data = {"key": "x" * 1000}
    for _ in range(4):
        data = {"key": "{a}" * 1_000_000, "values": {"a": data}}
    with pytest.raises(ValueError, match="more than 1000000 characters"):
        Message.parse(data)

    def take(text):
        if not isinstance(text, str) or len(text) > 20:
            raise ValueError(f"too long: {text:.10}")
        return text.upper()

    data = {"key": "x {A}", "values": {"a": {"key": "y {B}", "values": {"b": "z"}}}}
    assert str(Message.parse(data, take)) == "X Y Z"
    for name in ("key", "many"):
        with pytest.raises(ValueError, match="too long"):
            Message.parse({"key": "x", name: "x" * 21}, take)
    data["values"]["a"]["values"]["b"] = "z" * 21
    with pytest.raises(ValueError, match="too long"):
        Message.parse(data, take)
