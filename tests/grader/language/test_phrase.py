"""A phrase is its English text, and knows what it was made of."""

from __future__ import annotations

import pickle
from copy import deepcopy
from pathlib import Path

import pytest

from grader.errors import SubmissionError, UsageError
from grader.language.phrase import Phrase, fill, joined, listed, reason, say, say_many
from grader.result import json_file
from grader.text import one_line, place, without_controls


def test_it_is_the_english_text_with_its_values():
    made = say("It made {turns:.1f} turns in {file}.", turns=2.53, file="drive.py")
    assert made == "It made 2.5 turns in drive.py."
    assert (made.key, made.values["turns"]) == ("It made {turns:.1f} turns in {file}.", 2.53)


@pytest.mark.parametrize(
    ("n", "said"), [(0, "0 pins"), (1, "1 pin"), (2, "2 pins"), (4210, "4,210 pins")]
)
def test_one_and_many(n, said):
    assert say_many("{n:,} pin", "{n:,} pins", n) == said


def test_a_row_knows_its_parts():
    row = joined([say("one"), "2", joined([say("three"), "4"])], " ")
    assert (row, row.parts) == ("one 2 three4", ("one", " ", "2", " ", "three", "4"))
    assert all(isinstance(part, Phrase) for part in (row.parts[0], row.parts[4]))
    assert ("a " + say("b") + " c", ("a " + say("b")).parts) == ("a b c", ("a ", "b"))


@pytest.mark.parametrize(
    ("items", "said"),
    [([], ""), (["a"], "a"), (["a", "b"], "a and b"), (["a", "b", "c"], "a, b and c")],
)
def test_some_things_in_one_row(items, said):
    assert listed(items) == said


@pytest.mark.parametrize(
    "key",
    ["{none}", "{0}", "{}", "{a.real}", "{a[0]}", "{a:{a}}", "{a:999999}", "{a:.999f}", "{a", "a}"],
)
def test_a_key_asks_for_its_values_and_nothing_else(key):
    with pytest.raises(ValueError, match=r"no value for|expected|Single|encountered"):
        fill(key, {"a": 1})


def test_it_lives_through_copies_and_what_changes_nothing():
    made = say("{where}: {note}", where="a", note="b")
    for other in (deepcopy(made), made.strip(), one_line(made), without_controls(made)):
        assert other is made
    assert pickle.loads(pickle.dumps(made)).key == made.key


def test_an_exception_says_its_phrase_and_else_all_that_it_says():
    made = say("is damaged")
    assert reason(ValueError(made)) is made
    assert (reason(ValueError()), reason(ValueError("a", 1))) == ("", "('a', 1)")
    odd = UnicodeDecodeError("utf-8", b"\xff", 0, 1, "invalid start byte")
    assert reason(odd).endswith("invalid start byte")


@pytest.mark.parametrize("error", [ValueError(), ValueError("a", 1)])
def test_a_file_that_cannot_be_used_is_told_whatever_its_reader_raises(error):
    def make(data):
        raise error

    with pytest.raises(UsageError, match=r"result\.json "):
        json_file.made(make, Path("result.json"), {})


def test_what_changes_it_makes_a_plain_text():
    assert not isinstance(one_line(say("one\ntwo")), Phrase)
    assert not isinstance(say(" one ").strip(), Phrase)


def test_an_error_keeps_what_its_message_is_made_of():
    made = say("{where}: {note}", where="a", note="b")
    assert SubmissionError(made).message is made


def test_a_value_may_be_anything_that_has_a_text():
    assert say("{path} is there", path=Path("a/b")) == "a/b is there"


def test_a_place_is_a_phrase():
    assert place(5.544, 7.2).key == "({x:.2f}, {y:.2f})"
    assert place(float("nan"), 0).key == "an unknown place"
