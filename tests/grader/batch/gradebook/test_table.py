"""gradebook.csv and gradebook.jsonl: a row a person, whatever people are called."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest

from grader.batch.gradebook import lines, table
from grader.batch.gradebook.grade import grades
from grader.batch.hand_in import Person
from tests.grader.batch.gradebook.people import NAMES, judged, person, without_result


def rows(entries, **options):
    text = table.render(grades(entries, **options))
    assert text.startswith("\ufeff")  # for Excel; every reader of utf-8-sig takes it away
    return list(csv.DictReader(io.StringIO(text[1:]), strict=True))


def test_each_member_of_a_group_has_a_row(tmp_path: Path) -> None:
    first, second = rows([judged(tmp_path, person(0), person(2), deducted=3)])
    assert (first["id"], second["id"], second["name"]) == ("s0", "s2", "李小龙")
    assert {first["group"], second["group"]} == {"s0; s2"}
    assert (first["score"], first["late_deduction"], first["final"]) == ("18.33", "3.00", "15.33")
    assert (first["max_score"], first["state"], first["attempt"]) == ("40.00", "judged", "2")
    assert first["handed_in"] == "2026-11-02T09:15:00+00:00"
    assert [first[check] for check in ("starts", "draws", "rests")] == ["10.00", "8.33", "0.00"]


def test_nobody_pays_for_the_grader_and_nothing_is_worth_nothing() -> None:
    class_ = [
        without_result("nothing", person(0)),
        without_result("unusable", person(1), message="No Python file."),
        without_result("failed", person(2), message="The grader failed."),
    ]
    assert [row["final"] for row in rows(class_)] == ["0.00", "0.00", ""]
    assert [row["final"] for row in rows(class_, nothing_is_zero=False)] == ["", "0.00", ""]
    assert rows(class_)[1]["message"] == "No Python file."


@pytest.mark.parametrize("name", NAMES)
def test_no_name_is_a_formula_or_breaks_a_row(name: str) -> None:
    (row,) = rows([without_result("nothing", Person("s1", name))])
    assert not row["name"].startswith(tuple("=+-@\t"))
    assert row["name"].removeprefix("'") == " ".join(name.split())
    assert None not in row


def test_a_check_may_be_called_as_a_column_is(tmp_path: Path) -> None:
    from tests.grader.reports.samples import verdict

    listed = [verdict("final"), verdict("=1+1")]
    entry = judged(tmp_path, person(0), verdicts=listed, score=20, max_score=20)
    (row,) = rows([entry])
    assert (row["final"], row["final (check)"], row["'=1+1"]) == ("20.00", "10.00", "10.00")


def test_lines_of_json_have_everything_as_it_is(tmp_path: Path) -> None:
    class_ = [
        judged(tmp_path, person(3), person(6), deducted=30),
        without_result("failed", person(1), message="Why."),
    ]
    found = [json.loads(line) for line in lines.render(grades(class_)).splitlines()]
    first, second, third = found
    assert (first["name"], second["name"]) == (NAMES[3], NAMES[6])
    assert (first["score"], first["late_deduction"], first["final"]) == (18.33, 18.33, 0.0)
    assert first["checks"] == {"starts": 10, "draws": 8.33, "stops": 0, "rests": 0}
    assert (third["final"], third["state"], third["message"]) == (None, "failed", "Why.")
