"""The exercise sheet of a package says that nothing of it is started."""

from grader.exercise.loading import load_exercise
from tests.grader.exercise.test_sheet import sheet_of


def test_the_sheet_of_a_package_says_that_nothing_is_started():
    text = sheet_of("description_package")
    assert "Nothing of your package is started" in text
    assert "simulated seconds" not in text
    for check, points in load_exercise("description_package").points.items():
        assert f"| {points:g} | " in text and f"`{check}`" in text
