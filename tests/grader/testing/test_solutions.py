"""mutants.yaml is read, and what is wrong in it is named."""

import pytest

from grader.errors import ExerciseError
from grader.exercise.loading import load_exercise
from grader.exercise.places import names
from grader.testing.solutions import read_solutions
from tests.grader.testing import exercises
from tests.grader.testing.exercises import MUTANTS


def test_a_mutant_is_the_first_right_solution_with_something_replaced(tmp_path):
    exercise = load_exercise(exercises.write(tmp_path / "it"))
    right, slow, silent = read_solutions(exercise)
    assert [right.is_right, slow.is_right, silent.is_right] == [True, False, False]
    assert slow.text() == exercises.SOLUTION.replace("x = 1.0", "x = 0.1")
    assert (slow.leaves, silent.leaves) == ({"far": "some"}, {"commands": 0, "far": 0})
    assert right.lay_out(tmp_path) == exercise.folder / "solution.py"
    copy = slow.lay_out(tmp_path)
    assert (copy, copy.read_text()) == (tmp_path / "slow" / "solution.py", slow.text())


def test_the_solutions_may_lie_elsewhere(tmp_path):
    hidden = exercises.write(tmp_path / "hidden")
    shown = load_exercise(exercises.write(tmp_path / "shown"))
    (shown.folder / "mutants.yaml").unlink()
    assert len(read_solutions(shown, hidden / "mutants.yaml")) == 3
    with pytest.raises(ExerciseError, match="--mutants FILE"):
        read_solutions(shown)


def test_no_installed_exercise_shows_a_solution_that_was_not_there_before():
    assert len(read_solutions(load_exercise("turtlesim_challenge"))) > 20
    for name in names():
        files = load_exercise(name).folder.rglob("*.py")
        python = {each.name for each in files if not {"starter", "reference"} & {*each.parts}}
        assert not {file for file in python if "solution" in file or "controller" in file}


def changed(name, **words):
    return {**MUTANTS, "mutants": {name: words}}


@pytest.mark.parametrize(
    ("mutants", "words"),
    [
        ([], "right: expected names"),
        ({"right": {}}, "right: expected names"),
        ({"right": {"a": "none.py"}}, "there is no 'none.py'"),
        ({**MUTANTS, "mutants": [1]}, "mutants: expected names"),
        (changed("solution", file="silent.py"), "both a right solution and a mutant"),
        (changed("m", file="silent.py", replace=[]), "m: expected either `replace` or `file`"),
        (changed("m", file="silent.py", lost={}), "m: unknown 'lost'"),
        (changed("m", replace=["x"]), "replace: expected a list of old and new"),
        (changed("m", replace=[]), "nothing to replace"),
        (changed("m", replace=[{"old": "twist", "new": ""}]), "stands 3 times in solution.py"),
        (changed("m", replace=[{"old": "sing", "new": ""}]), "stands 0 times"),
        (changed("m", file="silent.py", leaves="half"), "leaves: expected 'nothing'"),
        (changed("m", file="silent.py", leaves={"fly": 0}), "no check is named 'fly'"),
        (changed("m", file="silent.py", leaves={"far": 2}), "expected a share below 1"),
    ],
)
def test_a_mistake_is_named(tmp_path, mutants, words):
    exercise = load_exercise(exercises.write(tmp_path, mutants=mutants))
    with pytest.raises(ExerciseError) as error:
        read_solutions(exercise)
    assert words in str(error.value)
    assert "mutants.yaml" in str(error.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("right: [1\n", r"line 2: "),
        ("right: {a: solution.py}\nmutant: {}\n", "line 2: mutant: unknown"),
        (
            "right: {a: solution.py}\nmutants:\n  m:\n    file: silent.py\n    leaves: {fly: 0}\n",
            "line 5: mutants: m: leaves: no check",
        ),
    ],
)
def test_a_slip_is_told_with_its_line(tmp_path, text, words):
    exercise = load_exercise(exercises.write(tmp_path))
    (tmp_path / "mutants.yaml").write_text(text)
    with pytest.raises(ExerciseError, match=rf"mutants\.yaml, {words}"):
        read_solutions(exercise)
