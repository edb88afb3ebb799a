"""What Canvas reads in what we write for it."""

from __future__ import annotations

import io
import zipfile
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path

import pytest

from grader.batch.entry import Person
from grader.batch.gradebook import canvas
from grader.batch.gradebook.grade import grades
from grader.batch.gradebook.write import CANVAS_FEEDBACK, notes, write
from grader.message import plain_text
from tests.grader.batch.gradebook import canvas_reads
from tests.grader.batch.gradebook.people import (
    NAMES,
    in_canvas,
    judged,
    person,
    without_result,
)

CLASS = range(len(NAMES))
USERS = {7000 + n: {"name": NAMES[n], "sis": f"sis-{n}", "login": f"login{n}"} for n in CLASS}


def imported(entries, wanted="Spiral in ROS"):
    everybody = grades(entries)
    content = canvas.gradebook(everybody, canvas.assignment_of(everybody, wanted))
    return canvas_reads.gradebook(content.encode("utf-8"), USERS)


def test_canvas_reads_everybodys_grade_whatever_they_are_called(tmp_path: Path) -> None:
    found = imported([judged(tmp_path, in_canvas(number)) for number in CLASS])
    assert found.grades == dict.fromkeys(USERS, "18.33")
    assert (found.assignment, found.points_possible, found.unknown) == ("4711", "40.00", [])


def test_by_the_ids_of_the_student_information_system_too(tmp_path: Path) -> None:
    by_sis = Person("a", "A", {"SIS User ID": "sis-1"})
    by_login = Person("b", "B", {"SIS Login ID": "login2"})
    found = imported([judged(tmp_path, by_sis), judged(tmp_path, by_login)])
    assert list(found.grades) == [7001, 7002]


def test_a_number_of_another_system_is_not_taken_for_canvass(tmp_path: Path) -> None:
    entry = judged(tmp_path, Person("7001", "Ada", {"ID": "7001", "Email": "ada@example.org"}))
    assert canvas.gradebook(grades([entry]), "Spiral") == ""


def test_what_is_not_known_takes_away_no_grade() -> None:
    nobody = without_result("nothing", in_canvas(1))
    failed = without_result("failed", in_canvas(2))
    assert imported([nobody, failed]).grades == {7001: "0.00"}


@pytest.mark.parametrize("wanted", ["Spiral", "4711", "Spiral (4711)"])
def test_an_assignment_is_known_by_title_or_number(wanted: str) -> None:
    entry = without_result("nothing", in_canvas(1, **{"Essay (12)": ""}))
    assert imported([entry], wanted).assignment == "4711"
    assert imported([entry], "Another").assignment == "Another"


def test_semicolons_in_names_do_not_cut_the_table() -> None:
    entries = [without_result("nothing", in_canvas(1, Student=";;;;;;;;;"))]
    assert list(imported(entries).grades) == [7001]


def test_canvas_gives_the_feedback_to_whoever_handed_in(tmp_path: Path) -> None:
    class_ = [judged(tmp_path, in_canvas(number)) for number in CLASS]
    class_.append(judged(tmp_path, person(99)))
    write(tmp_path, class_, plain_text("Spiral"))
    content = (tmp_path / "export" / CANVAS_FEEDBACK).read_bytes()
    submissions = {7000 + number: [90000 + number] for number in CLASS}
    found, ignored = canvas_reads.feedback_zip(content, submissions)
    assert found.keys() == submissions.keys()
    assert ignored == []
    path, inner = found[7001]
    assert path == "obrien_LATE_7001_90001_my_1_node.zip"
    assert zipfile.ZipFile(io.BytesIO(inner)).namelist() == ["feedback.html"]


def test_who_handed_in_a_program_gets_text(tmp_path: Path) -> None:
    name = "doejane_7001_90001_node.py"
    entry = judged(tmp_path, in_canvas(1, **{"Exported as": name}))
    write(tmp_path, [entry], plain_text("Spiral"))
    content = (tmp_path / "export" / CANVAS_FEEDBACK).read_bytes()
    found, _ = canvas_reads.feedback_zip(content, {7001: [90001]})
    assert found[7001][1].decode().startswith("## some\\_exercise: 18.33 of 40 points")


def test_a_group_has_one_file_and_a_row_for_each(tmp_path: Path) -> None:
    second = in_canvas(2, **{"Exported as": ""})
    entry = judged(tmp_path, in_canvas(1), second)
    write(tmp_path, [entry], plain_text("Spiral"))
    with zipfile.ZipFile(tmp_path / "export" / CANVAS_FEEDBACK) as archive:
        assert archive.namelist() == ["obrien_LATE_7001_90001_my_1_node.zip"]
    assert list(imported([entry]).grades) == [7001, 7002]


def test_nobody_is_in_an_import_twice(tmp_path: Path) -> None:
    older, newer = (judged(tmp_path / str(n), in_canvas(1)) for n in (1, 2))
    hand_in = replace(newer.hand_in, at=datetime(2026, 12, 1, tzinfo=UTC))
    newer = replace(newer, hand_in=hand_in)
    found = grades([newer, older, without_result("nothing", in_canvas(1))])
    assert [grade.final for grade in found] == [18.33, None, None]
    assert "with more than one hand-in" in str(notes(found, "Spiral")[0])
    assert [grade.final for grade in grades([older, older])] == [None, None]  # nothing tells


def test_an_id_in_a_table_of_ones_own_is_not_canvass(tmp_path: Path) -> None:
    columns = {"id": "7001", "name": "Ada", "email": "ada@example.org", "section": "A"}
    own = Person("7001", "Ada", columns)
    assert canvas.gradebook(grades([judged(tmp_path, own)]), "Spiral") == ""
    both = Person("17", "Bob", {"ID": "7002", "Exported as": "bob_7002_1_x.py", "id": "17"})
    assert list(imported([judged(tmp_path, both)]).grades) == [7002]


def test_who_typed_something_in_is_known_by_the_name_of_that() -> None:
    named = {"ID": "7001", "Exported as": "ada_LATE_7001_text.html"}
    entry = without_result("nothing", Person("7001", "ada", named))
    assert imported([entry]).grades == {7001: "0.00"}
    assert canvas.feedback_files(grades([entry])) == {}
