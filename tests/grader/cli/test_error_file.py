import json

import pytest

from grader.cli import main
from grader.system.strict_json import first_error
from tests.grader.reports import samples


@pytest.fixture
def error(tmp_path):
    return tmp_path / "errors" / "error.json"


def said(path):
    data = json.loads(path.read_text(encoding="utf-8"))
    assert first_error("grader.exercise.result", "error", data) is None
    return data["whose"], data["message"], data["max_score"]


def test_an_unusable_submission_is_the_students(tmp_path, error, capsys):
    empty = tmp_path / "empty"
    empty.mkdir()
    assert main(["run", str(empty), "--error-json", str(error)]) == 2
    whose, message, max_score = said(error)
    assert (whose, max_score) == ("submission", 100)
    assert message.startswith("empty is an empty folder.")
    assert capsys.readouterr().err == f"Fix this first: {message}\n"


@pytest.mark.parametrize(
    ("words", "part", "max_score"),
    [
        (["run", "--nonsense"], "required: submission", None),
        (["run", "x.py", "--nonsense", "--exercise", "square"], "--nonsense", 100),
        (["run", "x.py", "--time", "mine"], "invalid choice: 'mine'", None),
        (["run", "missing.py", "--exercise", "edited.yaml"], "missing.py does not exist", 6),
        (["check", "missing"], "missing does not exist", 100),
        (["report", "missing.json"], "cannot read the result missing.json", None),
        (["new", "/dev/null"], "is a file", 100),
        ([], "argument VERB", None),
    ],
)
def test_a_wrong_call_is_the_callers(tmp_path, error, monkeypatch, capsys, words, part, max_score):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "edited.yaml").write_text("exercise: square\npoints: {drives: 6}\n")
    assert main([*words, "--error-json", str(error)]) == 2
    whose, message, most = said(error)
    assert (whose, most) == ("call", max_score)
    assert part in message
    assert message in capsys.readouterr().err


def test_a_call_from_a_deleted_folder_is_told_so(tmp_path, error, monkeypatch, capsys):
    (gone := tmp_path / "gone").mkdir()
    monkeypatch.chdir(gone)
    gone.rmdir()
    assert main(["run", "x.py", "--error-json", str(error)]) == 2
    assert said(error)[:2] == ("call", capsys.readouterr().err.partition(": ")[2].strip())
    assert "folder was deleted" in said(error)[1]


def test_without_a_file_name_the_call_is_refused_all_the_same(capsys):
    assert main(["run", "x.py", "--error-json"]) == 2
    assert "usage: grader run" in capsys.readouterr().err


def test_an_error_file_that_cannot_be_written_is_found_out_at_the_start(tmp_path, capsys):
    assert main(["new", str(tmp_path / "new"), "--error-json", str(tmp_path)]) == 2
    assert "it is a folder" in capsys.readouterr().err
    assert not (tmp_path / "new").exists()


def test_an_old_file_does_not_outlive_a_call_that_works(tmp_path, error):
    assert main(["check", str(tmp_path / "missing"), "--error-json", str(error)]) == 2
    assert error.exists()
    assert main(["new", str(tmp_path / "new"), "--error-json", str(error)]) == 0
    assert not error.exists()


@pytest.mark.parametrize("exception", [RuntimeError("boom"), OSError(5, "Input/output error")])
def test_what_nobody_expected_is_the_graders(tmp_path, error, monkeypatch, capsys, exception):
    def fail(folder):
        raise exception

    monkeypatch.setattr("grader.cli.check.load_all", fail)
    assert main(["check", str(tmp_path), "--error-json", str(error)]) == 3
    whose, message, max_score = said(error)
    assert (whose, max_score) == ("grader", 100)
    assert str(exception) in message
    assert "Traceback" not in message
    assert "Traceback" in capsys.readouterr().err


def test_a_report_of_an_error_is_no_error(tmp_path, error, capsys):
    assert main(["run", str(tmp_path / "x.py"), "--error-json", str(error)]) == 2
    other = tmp_path / "other.json"
    assert main(["report", str(error), "--error-json", str(other)]) == 0
    assert capsys.readouterr().out.startswith("Not graded.\n")
    assert not other.exists()


def test_a_result_goes_to_a_descriptor_of_the_callers(tmp_path):
    """Its file may belong to another user: a course's CI lets nobody else write it."""
    result, out, error = (tmp_path / name for name in ("result.json", "out.txt", "error.json"))
    result.write_text(json.dumps(samples.result()))
    with out.open("w") as file:
        assert main(["report", str(result), "--out", f"/dev/fd/{file.fileno()}"]) == 0
    assert "Score: 18.33 of 40" in out.read_text()
    with error.open("w") as file:
        assert main(["report", "x.json", "--error-json", f"/dev/fd/{file.fileno()}"]) == 2
    assert said(error)[0] == "call"
