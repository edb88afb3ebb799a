"""Which lines of a submission run, and what its conditions are asked about."""

import traceback
from pathlib import Path

import pytest
import yaml

from grader.run.observe import lines
from grader.run.observe.files import SubmissionFiles
from grader.run.observe.lines import LineMarks

PROGRAMS = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text())


@pytest.fixture
def marks(tmp_path):
    return LineMarks(SubmissionFiles(str(tmp_path)))


def run(marks, tmp_path, name="drives"):
    program = PROGRAMS[name]
    file = str(tmp_path / "drive.py")
    names = {"__name__": "drive"}
    exec(marks.marked(compile(program, file, "exec"), program, file), names)
    (row,) = marks.rows()
    assert row["file"] == "drive.py"
    return row, names


def test_the_lines_that_run_are_known_and_no_others(marks, tmp_path):
    row, _ = run(marks, tmp_path)
    assert row["lines"] == [1, 2, 4, 5, 6, 7, 9, 10, 12, 13, 15, 17, 18, 19]


def test_a_conditions_names_are_shown_with_what_they_stood_for(marks, tmp_path):
    row, _ = run(marks, tmp_path)
    (asked,) = row["asked"]
    assert asked == {"line": 10, "text": "self.state = State.IDLE, self.x = 1.235, most = 3"}


def test_an_exception_that_the_program_catches_is_known_with_its_line(marks, tmp_path):
    row, _ = run(marks, tmp_path)
    (raised,) = row["raised"]
    assert raised["line"] == 13
    assert raised["text"] == "AttributeError: 'Node' object has no attribute 'lost'"


def test_a_value_is_looked_up_without_running_anything_of_the_program(marks, tmp_path):
    row, _ = run(marks, tmp_path, "is_odd")
    assert [at["text"] for at in row["asked"]] == ["odd = <Odd>"]
    assert row["raised"] == []


def test_a_program_is_the_same_with_marks_and_without(marks, tmp_path):
    file = str(tmp_path / "drive.py")
    plain = {"__name__": "drive"}
    exec(compile(PROGRAMS["is_of_all_kinds"], file, "exec"), plain)
    _, marked = run(marks, tmp_path, "is_of_all_kinds")
    for names in (plain, marked):
        assert (names["tick"](1), names["tick"](3), names["last"]) == ("n=1", "many", 3)
        assert (names["__doc__"], names["tick"].__doc__) == ("What it does.", "Count.")
        assert (names["C"].__doc__, names["C"].__annotations__) == ("A class.", {"x": "int"})
        with pytest.raises(ZeroDivisionError) as raised:
            names["tick"](2)
        last = traceback.extract_tb(raised.tb)[-1]
        assert (last.lineno, last.colno, last.name) == (9, 23, "tick")
    assert plain.keys() == marked.keys()
    assert hash(marked["tick"].__code__) is not None


def test_the_lines_of_others_and_of_very_large_files_are_not_noted(marks, tmp_path):
    code = compile("a = 1", "/usr/lib/a.py", "exec")
    assert marks.marked(code, "a = 1", "/usr/lib/a.py") is code
    file, text = str(tmp_path / "a.py"), "a = 1\n" * lines.MOST_BYTES
    code = compile("a = 1", file, "exec")
    assert marks.marked(code, text, file) is code
    assert marks.rows() == []
