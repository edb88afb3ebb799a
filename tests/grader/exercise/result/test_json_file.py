import json

import pytest

from grader.errors import ExerciseError, SubmissionError
from grader.exercise.result.json_file import ErrorResult
from grader.system.strict_json import first_error

ERROR = {
    "schema": "turtlesim-grader/error/v1",
    "whose": "submission",
    "message": "hand in a file",
    "max_score": 100.0,
}


def test_an_error_is_written_in_its_fixed_form(tmp_path):
    path = tmp_path / "error.json"
    ErrorResult.of(SubmissionError("hand in a file"), 100.0).write(path)
    assert json.loads(path.read_text()) == ERROR
    assert ErrorResult.from_json(json.loads(path.read_text())).to_json() == ERROR


def test_without_an_exercise_there_are_no_points_to_tell(tmp_path):
    found = ErrorResult.of(ExerciseError("line 3"), None).to_json()
    assert (found["whose"], found["max_score"]) == ("exercise", None)
    assert first_error("grader.exercise.result", "error", found) is None


@pytest.mark.parametrize("message", ["a\x1b[31mb\x00", "x\udcff", "one\r\ntwo"])
def test_whatever_the_text_a_file_comes_of_it(tmp_path, message):
    path = tmp_path / "error.json"
    ErrorResult.of(ExerciseError(message), None).write(path)
    text = json.loads(path.read_text(encoding="utf-8"))["message"]
    assert not set("\x1b\x00\r\udcff") & set(text)


@pytest.mark.parametrize(
    "change", [{"whose": "nobody"}, {"message": 1}, {"max_score": -1}, {"more": 1}, {"schema": ""}]
)
def test_what_does_not_follow_the_schema_is_refused(change):
    with pytest.raises(ValueError, match="is no error of turtlesim-grader/error/v1: "):
        ErrorResult.from_json(ERROR | change)
