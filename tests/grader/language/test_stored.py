"""Phrases in JSON: they come back as they were; what a stranger wrote is refused, or English."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from grader.errors import UsageError
from grader.language.catalogue import speak
from grader.language.phrase import Phrase, joined, say, say_many
from grader.language.stored import phrase, phrases_in, restored
from grader.reports import Report
from grader.result.result import Result
from tests.grader.reports import samples


@dataclass(frozen=True)
class Told:
    text: str
    notes: tuple[str, ...] = ()


SAID = Told(
    say("It made {turns:.1f} turns, {why}", turns=2.5, why=say("of {asked}.", asked=say("three"))),
    (joined([say("one"), " 2"]), say_many("{n} pin", "{n} pins", 3), "plain"),
)


def test_they_come_back_as_they_were():
    stored = json.loads(json.dumps(phrases_in(SAID)))
    texts = Told(str(SAID.text), tuple(map(str, SAID.notes)))
    back = restored(texts, stored)
    assert back == SAID
    assert phrases_in(back) == phrases_in(SAID)
    assert [type(each) for each in back.notes] == [Phrase, Phrase, str]


def test_numbers_of_numpy_and_what_is_no_number_of_json_are_stored():
    said = say("{a} {b} {c} {d}", a=np.float64(1.5), b=np.int64(2), c=float("nan"), d=Path("x"))
    values = phrases_in(said)[str(said)]["values"]
    assert values == {"a": 1.5, "b": 2, "c": "nan", "d": "x"}
    json.dumps(values, allow_nan=False)


def deep(levels):
    data = {"text": "x", "key": "x"}
    for _ in range(levels):
        data = {"text": "x", "key": "{a}", "values": {"a": data}}
    return data


@pytest.mark.parametrize(
    "data",
    [
        *(None, 1, "x", [], {"key": 1}, {"key": "x", "many": 2}),
        *({"parts": "ab"}, {"parts": [1]}, {"parts": [None]}, {"key": "x", "values": [1]}),
        *({"key": "{a}", "values": {"a": None}}, {"key": "{a}", "values": {"a": [1]}}),
        *({"key": "{a}", "values": {"a": {"key": "x"}}}, deep(13), deep(500)),
    ],
)
def test_what_is_no_phrase_is_refused(data):
    with pytest.raises(ValueError, match="expected"):
        phrase("x", data)


RATIONALE = "Rationale of starts."


def file_with(tmp_path, data):
    path = tmp_path / "result.json"
    path.write_text(json.dumps(samples.result(phrases={RATIONALE: data})))
    return path


@pytest.mark.parametrize(
    "data",
    [
        {},
        {"key": "x", "parts": []},
        {"key": "x", "code": "1"},
        {"values": {}},
        {"key": ["x"]},
        {"key": "{a}", "values": {"a": None}},
        deep(40),
    ],
)
def test_a_result_file_with_such_a_one_cannot_be_used_and_a_sentence_says_so(tmp_path, data):
    with pytest.raises(UsageError, match=r"result\.json"):
        Result.read(file_with(tmp_path, data))


@pytest.mark.parametrize("data", [deep(300), {"parts": ["x"] * 30_000}])
def test_one_that_has_no_end_is_refused_at_once(tmp_path, data):
    with pytest.raises(UsageError, match="is damaged: its phrases: expected"):
        Result.read(file_with(tmp_path, data))


def test_a_name_that_reads_as_a_sentence_stays_a_name():
    verdict = samples.result()["verdicts"][0]
    told = samples.result(phrases={verdict["status"]: {"key": "x", "words": {"fr": "ROULE"}}})
    speak("fr")
    assert Result.from_json(told).verdicts[0].status == verdict["status"]
    assert type(Result.from_json(told).verdicts[0].status) is str


KNOWN = "at {time_s:.2f} s, at {place}"


@pytest.mark.parametrize(
    "data",
    [
        {"key": KNOWN},
        {"key": KNOWN, "values": {"time_s": "x", "place": 1}},
        {"key": KNOWN, "values": {"time_s": 1e308, "place": ""}},
        {"key": "{a:99999999999}", "values": {"a": 1}},
        {"key": "{a.__class__.__mro__}", "values": {"a": 1}},
        {"key": "{a[0]}", "values": {"a": "x"}},
        {"key": "{a!r:>9999}", "values": {"a": "x"}},
        {"key": "{", "values": {}},
        {"key": "%s%n", "values": {}},
        {"key": "{n:,} call", "many": "{n:,} calls", "values": {"n": "x"}},
        {"key": "{n:,} call", "many": "{n:,} calls", "values": {"n": 1e308}},
        {"key": "{n:,} call", "many": "{n:,} calls"},
        {"key": "no such sentence", "many": "", "values": {"a": True}},
    ],
)
@pytest.mark.parametrize("language", ["en", "fr", "zh"])
def test_one_that_does_not_fit_its_sentence_is_shown_in_some_words(tmp_path, data, language):
    path = file_with(tmp_path, data)
    speak(language)
    shown = Report.read(path).verdicts[0].rationale
    assert shown
    assert len(shown) < 1000
    assert "<class" not in shown
