from dataclasses import replace
from datetime import UTC, datetime

from grader.exercise.result.result import SubmissionInfo
from grader_class.page.html import evenly, students
from tests.grader_class.page.classes import entry, result, student

GOOD = {"a": 10.0}


def test_a_name_is_one_plain_line_of_bounded_length_or_the_id():
    (one,) = students([entry("x", name="A\x1b[31m\u202eB\n" + "C" * 500)])
    assert one.name.startswith("A\ufffdB C")
    assert len(one.name) == 80
    (nameless,) = students([entry("4711")])
    assert (nameless.name, nameless.id) == ("4711", "4711")


def test_numbers_count_all_and_follow_neither_ids_nor_names_nor_the_order_of_entries():
    listed = [entry(f"s{k:02}", name=f"Name {k:02}") for k in range(30)]
    everybody = students(listed)
    assert everybody == students(reversed(listed))
    numbers = [one.number for one in everybody]
    assert sorted(numbers) == list(range(1, 31))
    assert numbers != sorted(numbers)


def test_the_report_is_beside_the_page_and_only_where_there_is_one():
    (one,) = students([entry("a+b@c.d-e_f", result(GOOD))])
    assert one.report == "submissions/a+b@c.d-e_f/report.html"
    assert student(state="nothing").report == ""


def test_how_late_it_was_is_told_with_what_it_cost():
    def late(**told):
        return student(replace(result(GOOD), handed_in=SubmissionInfo("zoe", **told))).late

    assert late(late_s=93_600, days=2, deducted=10) == "1 d 2 h, −10"
    assert late(late_s=90) == "0 h 1 min"
    assert late() == student(result(GOOD)).late == ""


def test_the_time_keeps_its_own_zone():
    at = datetime(2026, 11, 1, 12, tzinfo=UTC)
    assert student(result(GOOD), at=at).at_text == "2026-11-01 12:00+00:00"
    assert student(result(GOOD)).at_text == ""


def test_few_of_many_are_spread_over_all_scores():
    everybody = students(entry(f"s{k}", result({"a": k / 10})) for k in range(100))
    assert [one.entry.score for one in evenly(everybody, 4)] == [9.9, 7.4, 4.9, 2.4]
    assert len(evenly(everybody, 200)) == 100
