from dataclasses import replace

import pytest

from grader.text.message import Message, joined, msg, series
from grader_class.page.html import check_rows
from tests.grader.reports.samples import diagnosis
from tests.grader_class.page.classes import OFF, result

BAD, GOOD = {"a": 0.0, "b": 10.0}, {"a": 10.0, "b": 10.0}


def row(*results):
    return check_rows(results, {"a": 10.0, "b": 10.0})[0]


def said(*rationales):
    found = row(*(result(BAD, rationale) for rationale in rationales))
    return found.alike, found.first_line


def test_a_row_tells_how_many_passed_and_the_mean_of_the_points():
    results = [result(BAD), result(GOOD), result({"a": 5.0, "b": 10.0}), result({"b": 0.0})]
    a, b = check_rows(results, {"a": 10.0, "b": 10.0})
    assert (a.check, a.count, a.passed, a.mean, a.max_score) == ("a", 3, 1, 5.0, 10.0)
    assert (b.check, b.count, b.passed, b.mean) == ("b", 4, 3, 7.5)


def test_rows_follow_the_exercise_and_what_nobody_was_asked_has_none():
    rows = check_rows([result({"x": 0.0, **GOOD})], {"b": 10.0, "none": 1.0, "a": 10.0})
    assert [each.check for each in rows] == ["b", "a", "x"]
    assert check_rows([], {"a": 10.0}) == []


def test_where_all_passed_nothing_is_to_be_fixed():
    assert (row(result(GOOD)).first_line, row(result(GOOD)).alike) == ("", 0)


def test_what_a_run_shows_by_itself_comes_before_a_check_s_own_reason():
    crashed = result(BAD, diagnosis=diagnosis())
    assert row(crashed).first_line == "You crashed at 6.0 s (drive.py, line 39)."
    of_another = replace(crashed, diagnosis=replace(crashed.diagnosis, check="b"))
    assert row(of_another).first_line == "It is 1 m off."


def test_of_equals_the_check_s_own_line_is_shown_and_who_was_not_judged_has_none():
    crashed, off = result(BAD, diagnosis=diagnosis()), result(BAD, msg("You are off."))
    assert row(crashed, off).first_line == row(off, crashed).first_line == "You are off."
    waits = replace(off, verdicts=tuple(replace(v, status="not_judged") for v in off.verdicts))
    assert (row(waits).first_line, row(waits).alike) == ("", 0)


def test_the_line_is_what_most_are_told_whatever_its_values():
    assert said(*(OFF.given(metres=m) for m in (3, 2, 2)), msg("Gone.")) == (3, "It is 2 m off.")
    assert said(msg("b"), msg("a")) == said(msg("a"), msg("b")) == (1, "a")


@pytest.mark.parametrize(
    ("pair", "alike"),
    [
        ((Message.of("x 1"), Message.of("x 2")), 1),
        ((joined([OFF, msg("Gone.")], " "), joined([OFF.given(metres=2), msg("Gone.")], " ")), 2),
        ((joined([OFF, msg("Gone.")], " "), OFF), 1),
        ((msg("In {all}.", all=series(["I"])), msg("In {all}.", all=series(["II", "IV"]))), 2),
    ],
    ids=["texts", "rows", "a part of a row", "lists"],
)
def test_sentences_are_alike_if_they_differ_in_values_alone(pair, alike):
    assert said(*pair)[0] == alike


def test_a_line_is_one_of_a_bounded_length_without_control_characters():
    (_, line) = said(msg("{text}", text="a\n\x1b[31m" + "b" * 1000))
    assert len(line) <= 400 and line.isprintable()
