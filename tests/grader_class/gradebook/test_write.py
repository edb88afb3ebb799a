import csv
import io
import json
import zipfile

import pytest

from grader.text.message import Message
from grader_class.entry import Person
from grader_class.gradebook.feedback import Feedback
from grader_class.gradebook.grade import grades
from grader_class.gradebook.write import as_csv, as_lines, write
from tests.grader.reports.samples import MIXED, run, verdict
from tests.grader_class.gradebook.people import (
    NAMES,
    in_canvas,
    in_worksheet,
    judged,
    person,
    without_result,
)

TITLE = Message.of("Spiral")


def written(out):
    found = [*out.glob("gradebook.*"), *out.glob("export/*")]
    return {path.relative_to(out).as_posix(): path.read_bytes() for path in found}


def test_the_same_class_gives_the_same_bytes(tmp_path):
    people = (in_worksheet(0), in_canvas(1), person(2))
    for name, wall_s, isolation in (("a", 4.25, "domain 17"), ("b", 9.5, "domain 3")):
        circumstances = {"run": run(wall_s=wall_s, isolation=isolation)}
        class_ = [judged(tmp_path / name, each, **circumstances) for each in people]
        write(tmp_path / name, class_, TITLE)
    assert written(tmp_path / "a") == written(tmp_path / "b")
    assert len(written(tmp_path / "a")) == 8


def test_an_export_that_there_is_no_more_goes(tmp_path):
    write(tmp_path, [judged(tmp_path, in_worksheet(0))], TITLE)
    assert "export/moodle-feedback.zip" in written(tmp_path)
    (note,) = write(tmp_path, [judged(tmp_path, person(0))], TITLE)
    ours = {"gradebook.csv", "gradebook.jsonl"}
    assert written(tmp_path).keys() == {*ours, "export/feedback.zip", "export/notes.txt"}
    assert "--roster" in str(note)
    assert write(tmp_path, [], TITLE) == []  # nobody at all is a class too
    assert written(tmp_path).keys() == ours


def test_who_is_left_out_is_told(tmp_path):
    lower = in_worksheet(0, **{"Maximum Grade": "20,00"})
    others = [judged(tmp_path, person(number)) for number in range(1, 6)]
    failed = without_result("failed", in_worksheet(7))
    notes = write(tmp_path, [judged(tmp_path, lower), *others, failed], TITLE)
    told = "\n".join(map(str, notes))
    assert "and 2 more, of whom the participant number is not known" in told
    assert "a maximum of 20,00, the exercise of 40" in told
    assert "../../etc/passwd" not in told
    assert "two lines and a tab without" not in told
    assert "without a grade: the grader failed" in told
    assert (tmp_path / "export/notes.txt").read_text().splitlines() == list(map(str, notes))


@pytest.mark.parametrize(
    ("columns", "told"),
    [
        ({"Identifier": "Participant 17"}, ["numbers of groups"]),
        (
            {"SIS User ID": "sis-9"},
            ["which assignment 'Spiral' is", "Not in Canvas's feedback: Xaver"],
        ),
    ],
)
def test_what_is_missing_for_an_import_is_told(tmp_path, columns, told):
    notes = write(tmp_path, [judged(tmp_path, Person("x", "Xaver", columns))], TITLE)
    assert len(notes) == len(told)
    assert all(text in str(note) for text, note in zip(told, notes, strict=True))


def test_a_student_reads_nothing_of_what_is_hidden(tmp_path):
    hidden = verdict("secret", "failed", 0, rationale="The hidden start.", visible="after_due")
    listed = [*MIXED, hidden]
    entry = judged(tmp_path, in_worksheet(0), verdicts=listed, max_score=50)
    before, after = Feedback("student"), Feedback("after_due")
    assert b"The hidden start." in after.page(entry)
    assert b"The hidden start." not in before.page(entry)
    assert b"Title of secret" not in before.page(entry)
    (grade,) = grades([entry])
    assert before.sentence(grade).startswith("Graded automatically: 18.33 of 40 points.")


def test_what_strangers_wrote_is_text_in_a_page(tmp_path):
    unusable = without_result("unusable", person(0), message="There is no <Python> file.")
    assert b"There is no &lt;Python&gt; file." in Feedback().page(unusable)
    page = Feedback().page(judged(tmp_path, person(0)))
    assert b"&lt;script&gt;alert(1)" in page
    assert b"<script>alert(1)" not in page


def test_a_page_does_not_tell_when_a_line_was_logged_or_where_an_object_lay(tmp_path):
    entry = judged(tmp_path, person(0))
    line = "[INFO] [1795326736.957123456] [node]: <Pose object at 0x7f01aa33445566>\n"
    (entry.folder / "output.txt").write_text(line)
    assert b"[INFO] [...] [node]: &lt;Pose object at 0x...&gt;" in Feedback().page(entry)


def test_zips_have_no_dates_and_tables_as_many_cells_in_each_row(tmp_path):
    class_ = [judged(tmp_path, in_worksheet(n)) for n in (3, 1, 2)]
    class_ += [judged(tmp_path, in_canvas(n)) for n in (12, 13)]
    write(tmp_path, class_, TITLE)
    with zipfile.ZipFile(tmp_path / "export/moodle-feedback.zip") as archive:
        assert archive.testzip() is None
        assert {member.date_time for member in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        assert archive.namelist() == sorted(archive.namelist())
    tables = [data for name, data in written(tmp_path).items() if name.endswith(".csv")]
    assert len(tables) == 4
    for content in tables:
        rows = list(csv.reader(io.StringIO(content.decode("utf-8-sig")), strict=True))
        assert {len(row) for row in rows} == {len(rows[0])}


def test_no_link_in_the_place_of_an_export_is_followed(tmp_path):
    out, elsewhere = tmp_path / "class", tmp_path / "elsewhere"
    for folder in (out, elsewhere):
        folder.mkdir()
    (elsewhere / "notes.txt").write_text("mine")
    everybody = [judged(out, person(0))]
    (out / "export").symlink_to(elsewhere)
    write(out, everybody, TITLE)
    (out / "export" / "moodle-grade-import.csv").symlink_to(elsewhere / "notes.txt")
    write(out, everybody, TITLE)
    assert sorted(path.name for path in (out / "export").iterdir()) == ["feedback.zip", "notes.txt"]
    assert [path.read_text() for path in elsewhere.iterdir()] == ["mine"]


def rows(entries):
    text = as_csv(grades(entries))
    assert text.startswith("\ufeff")  # for Excel; every reader of utf-8-sig takes it away
    return list(csv.DictReader(io.StringIO(text[1:]), strict=True))


def test_each_member_of_a_group_has_a_row(tmp_path):
    first, second = rows([judged(tmp_path, person(0), person(2), deducted=3)])
    assert (first["id"], second["id"], second["name"]) == ("s0", "s2", "李小龙")
    assert {first["group"], second["group"]} == {"s0; s2"}
    assert (first["score"], first["late_deduction"], first["final"]) == ("18.33", "3.00", "15.33")
    assert (first["max_score"], first["state"], first["attempt"]) == ("40.00", "judged", "2")
    assert first["handed_in"] == "2026-11-02T09:15:00+00:00"
    assert [first[check] for check in ("starts", "draws", "rests")] == ["10.00", "8.33", "0.00"]


def test_nobody_pays_for_the_grader_and_nothing_is_worth_nothing():
    class_ = [
        without_result("nothing", person(0)),
        without_result("unusable", person(1), message="No Python file."),
        without_result("failed", person(2), message="The grader failed."),
    ]
    assert [row["final"] for row in rows(class_)] == ["0.00", "0.00", ""]
    assert rows(class_)[1]["message"] == "No Python file."


@pytest.mark.parametrize("name", NAMES)
def test_no_name_is_a_formula_or_breaks_a_row(name):
    (row,) = rows([without_result("nothing", Person("s1", name))])
    assert not row["name"].startswith(tuple("=+-@\t"))
    assert row["name"].removeprefix("'") == " ".join(name.split())
    assert None not in row


def test_a_check_may_be_called_as_a_column_is(tmp_path):
    listed = [verdict("final"), verdict("=1+1")]
    entry = judged(tmp_path, person(0), verdicts=listed, score=20, max_score=20)
    (row,) = rows([entry])
    assert (row["final"], row["final (check)"], row["'=1+1"]) == ("20.00", "10.00", "10.00")


def test_lines_of_json_have_everything_as_it_is(tmp_path):
    class_ = [
        judged(tmp_path, person(3), person(6), deducted=30),
        without_result("failed", person(1), message="Why."),
    ]
    found = [json.loads(line) for line in as_lines(grades(class_)).splitlines()]
    first, second, third = found
    assert (first["name"], second["name"]) == (NAMES[3], NAMES[6])
    assert (first["score"], first["late_deduction"], first["final"]) == (18.33, 18.33, 0.0)
    assert first["checks"] == {"starts": 10, "draws": 8.33, "stops": 0, "rests": 0}
    assert (third["final"], third["state"], third["message"]) == (None, "failed", "Why.")
