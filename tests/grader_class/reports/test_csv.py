import csv as stdlib_csv
import io

import pytest

from grader.exercise.result.json_file import ErrorResult
from grader.reports import read
from grader_class.reports import csv
from tests.grader.reports import samples
from tests.grader.reports.samples import verdict


def rows(*reports):
    return list(stdlib_csv.DictReader(io.StringIO(csv.render_all(reports)), strict=True))


def test_one_row_a_submission_with_points_and_verdict_of_each_check():
    first, second = rows(samples.report(), samples.report(submission="other.py"))
    assert (first["submission"], second["submission"]) == ("controller.py", "other.py")
    assert (first["score"], first["max_score"]) == ("18.33", "40")
    assert (first["draws"], first["draws verdict"]) == ("8.33", "failed")
    assert (first["rests"], first["rests verdict"]) == ("0", "not judged")
    assert first["first_to_mend"] == "draws: Rationale of draws."
    (row,) = rows(samples.report(diagnosis=samples.diagnosis()))
    assert row["first_to_mend"].startswith("crashed: You crashed at 6.0 s (drive.py, line 39).")
    first, second = rows(samples.report(verdict("a")), samples.report(verdict("b")))
    assert (first["a"], first["b"], first["b verdict"]) == ("10", "", "")
    assert (second["a"], second["b"]) == ("", "10")


@pytest.mark.parametrize("text", ["=1+1", "+1", "-1", "@SUM(A1)", "\t=1", "\n=1"])
def test_no_cell_is_a_formula(text):
    (row,) = rows(samples.report(verdict(text), submission=text))
    assert row["submission"] == f"'{text.strip()}"


def test_a_line_break_in_a_name_makes_no_row():
    content = csv.render(samples.report(submission='a\nb,"c"'))
    assert content.count("\n") == 2
    assert rows(samples.report(submission='a\nb,"c"'))[0]["submission"] == 'a b,"c"'


@pytest.mark.parametrize("file", ["alice.json", "alice/error.json"])
def test_an_error_tells_which_file_it_is_from(tmp_path, file):
    path = tmp_path / file
    ErrorResult("submission", "hand in a file", 100.0).write(path)
    (row,) = rows(read(path))
    assert (row["submission"], row["folder"]) == ("alice", str(path))
