"""`grader new`: the starter of the challenge, or of another exercise."""

from __future__ import annotations

import pytest

from grader.cli import main
from grader.errors import ExerciseError
from grader.exercise.loading import load_exercise
from tests.grader.testing import exercises


def test_the_challenge_s_starter_comes_by_itself(tmp_path, capsys):
    assert main(["new", str(tmp_path / "mine")]) == 0
    assert (tmp_path / "mine" / "setup.py").is_file()
    assert capsys.readouterr().out.splitlines() == [
        f"The starter package is in {tmp_path / 'mine'}.",
        "Fill in the TODOs of turtlesim_challenge/turtle_controller.py, then run:",
        f"    grader run {tmp_path / 'mine'}",
    ]


def test_an_exercise_elsewhere_has_its_own(tmp_path, capsys):
    exercise = exercises.write(tmp_path / "ahead", starter="begin")
    (exercise / "begin").mkdir()
    (exercise / "begin" / "node.py").write_text("print('nothing')\n")
    assert main(["new", str(tmp_path / "mine"), "--exercise", str(exercise)]) == 0
    assert [path.name for path in (tmp_path / "mine").iterdir()] == ["node.py"]
    assert capsys.readouterr().out.splitlines()[1:] == [
        "Then run:",
        f"    grader run {tmp_path / 'mine'} --exercise {exercise}",
    ]


def test_where_there_is_none_that_is_said_and_nothing_is_written(tmp_path, capsys):
    assert main(["new", str(tmp_path / "mine"), "--exercise", "square"]) == 2
    assert "the exercise 'square' has no starter" in capsys.readouterr().err
    assert not (tmp_path / "mine").exists()


def test_a_starter_must_be_a_folder(tmp_path):
    exercise = exercises.write(tmp_path / "ahead", starter="checks.py")
    with pytest.raises(ExerciseError, match="starter: expected a folder"):
        load_exercise(exercise)
