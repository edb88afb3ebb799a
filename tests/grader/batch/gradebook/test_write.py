"""The files of a gradebook: which there are, that they stay the same, what is said of them."""

from __future__ import annotations

import csv
import io
import zipfile
from pathlib import Path

from grader.batch.gradebook.feedback import Feedback
from grader.batch.gradebook.grade import grades
from grader.batch.gradebook.write import Options, write
from grader.batch.hand_in import Person
from tests.grader.batch.gradebook.people import (
    in_canvas,
    in_worksheet,
    judged,
    person,
    without_result,
)
from tests.grader.reports.samples import MIXED, run, verdict

OPTIONS = Options("Spiral")


def written(out: Path) -> dict[str, bytes]:
    found = [*out.glob("gradebook.*"), *out.glob("export/*")]
    return {path.relative_to(out).as_posix(): path.read_bytes() for path in found}


def test_the_same_class_gives_the_same_bytes(tmp_path: Path) -> None:
    people = (in_worksheet(0), in_canvas(1), person(2))
    for name, wall_s, isolation in (("a", 4.25, "domain 17"), ("b", 9.5, "domain 3")):
        circumstances = {"run": run(wall_s=wall_s, isolation=isolation)}
        class_ = [judged(tmp_path / name, each, **circumstances) for each in people]
        write(tmp_path / name, class_, OPTIONS)
    assert written(tmp_path / "a") == written(tmp_path / "b")
    assert len(written(tmp_path / "a")) == 8


def test_an_export_that_there_is_no_more_goes(tmp_path: Path) -> None:
    write(tmp_path, [judged(tmp_path, in_worksheet(0))], OPTIONS)
    assert "export/moodle-feedback.zip" in written(tmp_path)
    notes = write(tmp_path, [judged(tmp_path, person(0))], OPTIONS)
    assert written(tmp_path).keys() == {
        *("gradebook.csv", "gradebook.jsonl", "export/feedback.zip", "export/notes.txt")
    }
    assert len(notes) == 1
    assert "--roster" in notes[0]


def test_nobody_at_all_is_a_class_too(tmp_path: Path) -> None:
    assert write(tmp_path, [], OPTIONS) == []
    assert written(tmp_path).keys() == {"gradebook.csv", "gradebook.jsonl"}


def test_who_is_left_out_is_told(tmp_path: Path) -> None:
    lower = in_worksheet(0, **{"Maximum Grade": "20,00"})
    others = [judged(tmp_path, person(number)) for number in range(1, 6)]
    failed = without_result("failed", in_worksheet(7))
    notes = write(tmp_path, [judged(tmp_path, lower), *others, failed], OPTIONS)
    told = "\n".join(notes)
    assert "and 2 more, of whom the participant number is not known" in told
    assert "a maximum of 20,00, the exercise of 40" in told
    assert "../../etc/passwd" not in told
    assert "two lines and a tab without" not in told
    assert "without a grade: the grader failed" in told
    assert (tmp_path / "export/notes.txt").read_text().splitlines() == notes


def test_numbers_that_may_be_those_of_groups_are_told(tmp_path: Path) -> None:
    by_name = Person("1", "Team 1", {"Identifier": "Participant 17"})
    (note,) = write(tmp_path, [judged(tmp_path, by_name)], OPTIONS)
    assert "numbers of groups" in note


def test_of_canvas_it_is_told_what_is_missing(tmp_path: Path) -> None:
    nameless = Person("x", "Xaver", {"SIS User ID": "sis-9"})
    note, other = write(tmp_path, [judged(tmp_path, nameless)], OPTIONS)
    assert "which assignment 'Spiral' is" in note
    assert "Not in Canvas's feedback: Xaver" in other


def test_a_student_reads_nothing_of_what_is_hidden(tmp_path: Path) -> None:
    hidden = verdict("secret", "failed", 0, rationale="The hidden start.", visible="after_due")
    listed = [*MIXED, hidden]
    entry = judged(tmp_path, in_worksheet(0), verdicts=listed, max_score=50)
    before, after = Feedback("student"), Feedback("after_due")
    assert b"The hidden start." in after.page(entry)
    assert b"The hidden start." not in before.page(entry)
    assert b"Title of secret" not in before.page(entry)
    (grade,) = grades([entry])
    assert before.sentence(grade).startswith("Graded automatically: 18.33 of 40 points.")


def test_a_page_tells_a_student_why_nothing_could_be_started() -> None:
    entry = without_result("unusable", person(0), message="There is no <Python> file.")
    page = Feedback().page(entry)
    assert b"There is no &lt;Python&gt; file." in page


def test_what_a_node_printed_is_text_in_a_page(tmp_path: Path) -> None:
    page = Feedback().page(judged(tmp_path, person(0)))
    assert b"&lt;script&gt;alert(1)" in page
    assert b"<script>alert(1)" not in page


def test_a_page_does_not_tell_when_a_line_was_logged_or_where_an_object_lay(
    tmp_path: Path,
) -> None:
    pages = []
    for at, place in (("1795326736.957123456", "0x7f01aa"), ("1795326999.000000001", "0x7f02bb")):
        entry = judged(tmp_path / place, person(0))
        line = f"[INFO] [{at}] [node]: <Pose object at {place}33445566>\n"
        (entry.folder / "output.txt").write_text(line)
        pages.append(Feedback().page(entry))
    assert pages[0] == pages[1]
    assert b"[INFO] [...] [node]: &lt;Pose object at 0x...&gt;" in pages[0]


def test_zips_have_no_dates_and_are_whole(tmp_path: Path) -> None:
    write(tmp_path, [judged(tmp_path, in_worksheet(n)) for n in (3, 1, 2)], OPTIONS)
    with zipfile.ZipFile(tmp_path / "export/moodle-feedback.zip") as archive:
        assert archive.testzip() is None
        assert {member.date_time for member in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
        assert archive.namelist() == sorted(archive.namelist())


def test_every_table_has_as_many_cells_in_each_row(tmp_path: Path) -> None:
    class_ = [judged(tmp_path, in_worksheet(n)) for n in range(12)]
    class_ += [judged(tmp_path, in_canvas(n)) for n in range(12, 24)]
    write(tmp_path, class_, OPTIONS)
    tables = {name: data for name, data in written(tmp_path).items() if name.endswith(".csv")}
    assert len(tables) == 4
    for content in tables.values():
        rows = list(csv.reader(io.StringIO(content.decode("utf-8-sig")), strict=True))
        assert {len(row) for row in rows} == {len(rows[0])}


def test_no_link_in_the_place_of_an_export_is_followed(tmp_path: Path) -> None:
    out, elsewhere = tmp_path / "class", tmp_path / "elsewhere"
    for folder in (out, elsewhere):
        folder.mkdir()
    (elsewhere / "notes.txt").write_text("mine")
    everybody = [judged(out, person(0))]
    (out / "export").symlink_to(elsewhere)
    write(out, everybody, OPTIONS)
    (out / "export" / "moodle-grade-import.csv").symlink_to(elsewhere / "notes.txt")
    write(out, everybody, OPTIONS)
    assert sorted(path.name for path in (out / "export").iterdir()) == ["feedback.zip", "notes.txt"]
    assert [path.read_text() for path in elsewhere.iterdir()] == ["mine"]
