"""An instructor's edited copy of an exercise is read, and what is wrong in it is named."""

from __future__ import annotations

import pytest
import yaml

from grader.errors import ExerciseError
from grader.exercise.loading import load_exercise, names

NAME = "turtlesim_challenge"


def edited(tmp_path, **changes):
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump({"exercise": NAME, **changes}))
    return str(path)


def test_every_installed_exercise_loads():
    for name in names():
        assert load_exercise(name).points


def test_an_edited_copy_changes_what_it_names_and_nothing_else(tmp_path):
    original = load_exercise(NAME)
    copy = load_exercise(edited(tmp_path, limits={"rest_s": 1}, points={"moves": 3}))
    assert (copy.limits.rest_s, copy.limits.total_s) == (1, original.limits.total_s)
    assert copy.points == {"moves": 3}
    assert copy.tolerances == original.tolerances


def test_the_same_seed_gives_the_same_starts():
    exercise = load_exercise(NAME)
    assert exercise.starts() == exercise.starts()
    assert exercise.starts(1) != exercise.starts(2)
    assert len(exercise.starts()) == exercise.varied.count


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"exercise": "chess"}, "exercise: expected one of"),
        ({"points": {"fly": 1}}, "points: no check is named 'fly'"),
        ({"points": {"moves": float("nan")}}, "points: moves: expected a number from 0"),
        ({"points": {"moves": -1}}, "points: moves: expected a number from 0"),
        ({"points": {}}, "points: expected check names with points"),
        ({"limits": {"rest_s": "long"}}, "limits: rest_s: expected e.g. 3, found 'long'"),
        ({"limits": 5}, "limits: expected names with numbers, found 5"),
        ({"tolerances": {"edgem": 1}}, "tolerances: unknown 'edgem'"),
    ],
)
def test_a_mistake_in_an_edited_copy_is_named(tmp_path, changes, words):
    with pytest.raises(ExerciseError) as error:
        load_exercise(edited(tmp_path, **changes))
    assert words in str(error.value)


@pytest.mark.parametrize("text", ["a: [1", "just words", "- 1", "\x00"])
def test_what_is_no_yaml_object_is_refused(tmp_path, text):
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    with pytest.raises(ExerciseError, match="is not an exercise"):
        load_exercise(str(path))


def test_a_syntax_error_is_named_with_its_line(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text("exercise: x\npoints: [1\nlimits: {}\n")
    with pytest.raises(ExerciseError, match="line 3"):
        load_exercise(str(path))


def test_an_unknown_name_lists_the_known_ones():
    with pytest.raises(ExerciseError, match=NAME):
        load_exercise("chess")
