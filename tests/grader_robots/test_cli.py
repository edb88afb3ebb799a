"""Verbs refuse what the scenes of robots do not have."""

import pytest

from grader.cli import main
from grader.exercise.loading import load_exercise


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
