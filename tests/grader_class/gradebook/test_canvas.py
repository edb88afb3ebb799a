import io
import zipfile
from dataclasses import replace
from datetime import UTC, datetime

import pytest

from grader.text.message import Message
from grader_class.entry import Person
from grader_class.gradebook import canvas
from grader_class.gradebook.grade import grades
from grader_class.gradebook.write import CANVAS_FEEDBACK, notes, write
from tests.grader_class.gradebook import canvas_reads
from tests.grader_class.gradebook.people import NAMES, in_canvas, judged, person, without_result

CLASS = range(len(NAMES))
USERS = {7000 + n: {"name": NAMES[n], "sis": f"sis-{n}", "login": f"login{n}"} for n in CLASS}


def imported(entries, wanted="Spiral in ROS"):
    everybody = grades(entries)
    content = canvas.gradebook(everybody, canvas.assignment_of(everybody, wanted))
    return canvas_reads.gradebook(content.encode("utf-8"), USERS)


def test_canvas_reads_everybodys_grade_whatever_they_are_called(tmp_path):
    odd = in_canvas(1, Student=";;;;;;;;;")  # does not cut the table
    class_ = [odd if number == 1 else in_canvas(number) for number in CLASS]
    found = imported([judged(tmp_path, each) for each in class_])
    assert found.grades == dict.fromkeys(USERS, "18.33")
    assert (found.assignment, found.points_possible, found.unknown) == ("4711", "40.00", [])


def test_by_the_ids_of_the_student_information_system_too(tmp_path):
    by_sis = Person("a", "A", {"SIS User ID": "sis-1"})
    by_login = Person("b", "B", {"SIS Login ID": "login2"})
    found = imported([judged(tmp_path, by_sis), judged(tmp_path, by_login)])
    assert list(found.grades) == [7001, 7002]


def test_what_is_not_known_takes_away_no_grade():
    nobody = without_result("nothing", in_canvas(1))
    failed = without_result("failed", in_canvas(2))
    assert imported([nobody, failed]).grades == {7001: "0.00"}


@pytest.mark.parametrize("wanted", ["Spiral", "4711", "Spiral (4711)"])
def test_an_assignment_is_known_by_title_or_number(wanted):
    entry = without_result("nothing", in_canvas(1, **{"Essay (12)": ""}))
    assert imported([entry], wanted).assignment == "4711"
    assert imported([entry], "Another").assignment == "Another"


def feedback(folder, entries, submissions):
    write(folder, entries, Message.of("Spiral"))
    content = (folder / "export" / CANVAS_FEEDBACK).read_bytes()
    return canvas_reads.feedback_zip(content, submissions)


def test_canvas_gives_the_feedback_to_whoever_handed_in(tmp_path):
    class_ = [judged(tmp_path, in_canvas(number)) for number in CLASS]
    submissions = {7000 + number: [90000 + number] for number in CLASS}
    found, ignored = feedback(tmp_path, [*class_, judged(tmp_path, person(99))], submissions)
    assert found.keys() == submissions.keys()
    assert ignored == []
    path, inner = found[7001]
    assert path == "obrien_LATE_7001_90001_my_1_node.zip"
    assert zipfile.ZipFile(io.BytesIO(inner)).namelist() == ["feedback.html"]


def test_who_handed_in_a_program_gets_text(tmp_path):
    entry = judged(tmp_path, in_canvas(1, **{"Exported as": "doejane_7001_90001_node.py"}))
    found, _ = feedback(tmp_path, [entry], {7001: [90001]})
    assert found[7001][1].decode().startswith("## some\\_exercise: 18.33 of 40 points")


def test_a_group_has_one_file_and_a_row_for_each(tmp_path):
    entry = judged(tmp_path, in_canvas(1), in_canvas(2, **{"Exported as": ""}))
    found, _ = feedback(tmp_path, [entry], {7001: [90001]})
    assert found.keys() == {7001}
    assert list(imported([entry]).grades) == [7001, 7002]


def test_nobody_is_in_an_import_twice(tmp_path):
    older, newer = (judged(tmp_path / str(n), in_canvas(1)) for n in (1, 2))
    hand_in = replace(newer.hand_in, at=datetime(2026, 12, 1, tzinfo=UTC))
    newer = replace(newer, hand_in=hand_in)
    found = grades([newer, older, without_result("nothing", in_canvas(1))])
    assert [grade.final for grade in found] == [18.33, None, None]
    assert "with more than one hand-in" in str(notes(found, "Spiral")[0])
    assert [grade.final for grade in grades([older, older])] == [None, None]  # nothing tells


def test_an_id_of_another_system_or_in_a_table_of_ones_own_is_not_canvass(tmp_path):
    for columns in ({"ID": "7001", "Email": "a@x.org"}, {"id": "7001", "section": "A"}):
        entry = judged(tmp_path, Person("7001", "Ada", columns))
        assert canvas.gradebook(grades([entry]), "Spiral") == ""
    both = Person("17", "Bob", {"ID": "7002", "Exported as": "bob_7002_1_x.py", "id": "17"})
    assert list(imported([judged(tmp_path, both)]).grades) == [7002]


def test_who_typed_something_in_is_known_by_the_name_of_that():
    named = {"ID": "7001", "Exported as": "ada_LATE_7001_text.html"}
    entry = without_result("nothing", Person("7001", "ada", named))
    assert imported([entry]).grades == {7001: "0.00"}
    assert canvas.feedback_files(grades([entry])) == {}
