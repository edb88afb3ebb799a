import io
import zipfile
from dataclasses import replace

import pytest

from grader.text.message import Message
from grader_class.entry import Person
from grader_class.find.joining import UNCLEAR
from grader_class.gradebook import moodle
from grader_class.gradebook.feedback import Feedback
from grader_class.gradebook.grade import grades
from grader_class.gradebook.write import MOODLE_FEEDBACK, notes, write
from tests.grader_class.gradebook import moodle_reads
from tests.grader_class.gradebook.people import (
    MAXIMUM,
    NAMES,
    in_worksheet,
    judged,
    person,
    without_result,
)

CLASS = range(len(NAMES))
PARTICIPANTS = {1000 + number for number in CLASS}


def worksheet(entries):
    content = moodle.worksheet(grades(entries), Feedback()).encode("utf-8")
    return moodle_reads.worksheet(content, PARTICIPANTS, MAXIMUM)


def test_moodle_reads_everybodys_grade_whatever_they_are_called(tmp_path):
    found = worksheet([judged(tmp_path, in_worksheet(number)) for number in CLASS])
    assert {number: graded.grade for number, graded in found.items()} == dict.fromkeys(
        PARTICIPANTS, 18.33
    )


def test_a_group_has_a_row_for_each_and_what_is_late_costs(tmp_path):
    found = worksheet([judged(tmp_path, in_worksheet(0), in_worksheet(1), deducted=5)])
    assert {graded.grade for graded in found.values()} == {13.33}
    assert found[1001].comment == (
        "Graded automatically: 13.33 of 40 points (18.33 less 5 for being late). "
        "Rationale of draws."
    )


def test_the_folder_names_of_an_export_are_enough(tmp_path):
    by_identifier = Person("1", "Ada", {"Identifier": "Participant 1001"})
    by_name = Person("2", "Bob", {"Exported as": "Bob_1002_assignsubmission_file_"})
    by_number = Person("3", "Cy", {"Identifier": "1003"})
    found = worksheet([judged(tmp_path, each) for each in (by_identifier, by_name, by_number)])
    assert list(found) == [1001, 1002, 1003]


def test_a_groups_number_is_not_taken_for_that_of_a_student_in_the_worksheet(tmp_path):
    group = Person("1003", "Team 3", {"Identifier": "Participant 1003"})
    class_ = [judged(tmp_path, in_worksheet(1)), judged(tmp_path, group)]
    assert worksheet(class_).keys() == {1001}
    told = write(tmp_path, class_, Message.of("Spiral"))
    assert "Not in Moodle's grading worksheet and feedback: Team 3" in str(told[0])
    content = (tmp_path / "export" / MOODLE_FEEDBACK).read_bytes()
    assert moodle_reads.feedback_zip(content, PARTICIPANTS).keys() == {1001}


def test_of_whom_nothing_is_known_is_left_as_he_is(tmp_path):
    failed = without_result("failed", in_worksheet(0))
    assert worksheet([failed, judged(tmp_path, in_worksheet(1))]).keys() == {1001}
    assert moodle.worksheet(grades([failed, judged(tmp_path, person(1))]), Feedback()) == ""


def test_a_teachers_comment_stays_and_an_older_one_of_ours_goes(tmp_path):
    theirs = in_worksheet(0, **{"Feedback comments": "<p>See me, it's\nfine</p>"})
    ours = in_worksheet(1, **{"Feedback comments": "<p>Graded automatically: 0 of 40</p>"})
    found = worksheet([judged(tmp_path, theirs), judged(tmp_path, ours)])
    assert found[1000].comment == "<p>See me, it's fine</p>"
    assert "18.33 of 40" in found[1001].comment


def test_a_comment_is_text_though_moodle_takes_it_for_a_page():
    entry = without_result("unusable", in_worksheet(0), message="<img src=x> & no Python file.")
    comment = worksheet([entry])[1000].comment
    assert comment.endswith("&lt;img src=x&gt; &amp; no Python file.")


def test_the_gradebook_import_finds_all_by_one_column(tmp_path):
    class_ = [judged(tmp_path, in_worksheet(number)) for number in CLASS]
    class_.append(judged(tmp_path, person(99)))  # without an address: never another one's grade
    content = moodle.grade_import(grades(class_), "=Spiral", Feedback()).encode("utf-8")
    users = {f"s{number}@example.org": number for number in CLASS}
    found = moodle_reads.grade_import(content, "Email address", "'=Spiral", users)
    assert found == dict.fromkeys(CLASS, 18.33)


def test_the_gradebook_import_takes_what_most_have(tmp_path):
    numbered = [person(number, idnumber=f"00{number}") for number in (1, 2)]
    numbered.append(person(3, email="s3@example.org"))
    class_ = [judged(tmp_path, each) for each in numbered]
    content = moodle.grade_import(grades(class_), "Spiral", Feedback()).encode("utf-8")
    found = moodle_reads.grade_import(content, "ID number", "Spiral", {"001": 1, "002": 2})
    assert found == {1: 18.33, 2: 18.33}


@pytest.mark.parametrize(
    ("address", "is_in"),
    [
        ("=1+1@example.org", False),
        ("-cmd|' /C calc'!A0", False),
        ("a\nb@example.org", False),
        ("+anna@example.org", True),
    ],
)
def test_an_id_that_would_be_a_formula_is_in_no_import(tmp_path, address, is_in):
    entry = judged(tmp_path, person(0, email=address))
    content = moodle.grade_import(grades([entry]), "Spiral", Feedback())
    assert (f"\n{address}," in content) == bool(content) == is_in


def test_moodle_gives_each_student_the_page_and_nobody_anothers(tmp_path):
    class_ = [judged(tmp_path, in_worksheet(number)) for number in CLASS[2:]]
    class_.append(judged(tmp_path, in_worksheet(0), in_worksheet(1)))
    write(tmp_path, class_, Message.of("Spiral"))
    content = (tmp_path / "export" / MOODLE_FEEDBACK).read_bytes()
    found = moodle_reads.feedback_zip(content, PARTICIPANTS)
    assert found.keys() == PARTICIPANTS
    assert {name for given in found.values() for name in given} == {"feedback.html"}
    assert found[1000] == found[1001] != found[1002]
    names = zipfile.ZipFile(io.BytesIO(content)).namelist()  # none leads anywhere else
    assert not [name for name in names if set('/\\:*?"<>|\n') & set(name) or name[0] in ".~"]
    assert "Zoë Müller-Łukasiewicz_1000_assignsubmission_file_feedback.html" in names
    assert "Participant_1011_assignsubmission_file_feedback.html" not in names  # he has an id


def test_whose_hand_in_is_not_clear_gets_no_grade():
    missing = without_result("nothing", Person("900", "Max", {"ID number": "900"}))
    unclear = without_result("nothing", Person("901", "Mia", {"ID number": "901"}))
    unclear = replace(unclear, hand_in=replace(unclear.hand_in, problem=UNCLEAR))
    everybody = grades([missing, unclear])
    assert [grade.final for grade in everybody] == [0.0, None]
    table = moodle.grade_import(everybody, "Spiral", Feedback())
    assert "900" in table
    assert "901" not in table
    assert "not clear which hand-in is theirs: Mia" in str(notes(everybody, "Spiral")[0])
