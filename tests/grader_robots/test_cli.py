"""Exercises about robots on the command line, on sheets and in results of long ago."""

import pytest

from grader import grading
from grader.cli import main
from grader.exercise.loading import load_exercise
from grader.recording.subject import Role
from grader.run.opening import marks_of
from grader.submission.reader import Marks
from tests.grader.exercise.result.test_kept import OF_ROBOTS, expect_judged_as_then
from tests.grader.exercise.test_sheet import expect_all_told, sheet_of
from tests.grader_robots.packages import EXERCISE, REFERENCE


@pytest.mark.parametrize(
    ("exercise", "scene"), [("state_publisher", "robot"), ("description_package", "package")]
)
def test_a_page_that_there_is_not_is_refused_before_anything_is_written(
    exercise, scene, tmp_path, capfd
):
    out = tmp_path / "out"
    reference = load_exercise(exercise).folder / "reference"
    words = ["run", str(reference), "--live", "--exercise", exercise, "--out", str(out)]
    assert main(words) == 2
    assert f"its scene '{scene}' has no such page" in " ".join(capfd.readouterr().err.split())
    assert not out.exists()


def test_a_package_that_is_plainly_for_another_one_is_graded_by_that():
    name, said = grading.exercise_for(REFERENCE, marks_of(REFERENCE))
    assert name == "description_package"
    assert "by what the source has; another one: --exercise NAME" in str(said)


def test_a_hand_in_fits_the_exercise_of_which_it_has_all_on_the_graph():
    marks = Marks(programs=1, roles=(Role("publisher", "/joint_states"),))
    assert grading.fitting_exercises(marks) == ["state_publisher"]


@pytest.mark.parametrize(
    "marks", [Marks(files=("a.urdf", "node.py"), programs=1), Marks(files=("package.xml",))]
)
def test_files_are_those_of_an_exercise_only_without_a_program(marks):
    assert grading.fitting_exercises(marks) == []


def test_the_sheet_of_an_exercise_of_ours_tells_task_points_limits_and_how_to_begin():
    expect_all_told("state_publisher", ("    (cd mine && python3 -m pkg.node)\n", "rviz2"))


def test_the_sheet_of_a_package_says_that_nothing_is_started():
    text = sheet_of("description_package")
    assert "Nothing of your package is started" in text
    assert "simulated seconds" not in text
    for check, points in EXERCISE.points.items():
        assert f"| {points:g} | " in text and f"`{check}`" in text


@pytest.mark.parametrize("name", OF_ROBOTS)
def test_it_is_judged_as_it_was_then(name, tmp_path):
    expect_judged_as_then(name, tmp_path)
