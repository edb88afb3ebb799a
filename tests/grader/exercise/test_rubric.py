"""The rubric in the docs says what the checks say, with the numbers of the exercise."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest

from grader.exercise.loading import load_exercise
from grader.exercise.rubric import rubric

ROOT = Path(__file__).parents[3]


def test_the_page_in_the_docs_is_the_one_that_the_checks_make():
    page = runpy.run_path(str(ROOT / "scripts" / "rubric.py"))["page"]
    shown = (ROOT / "docs" / "rubric.md").read_text(encoding="utf-8")
    assert shown == page(shown), "run python scripts/rubric.py"


@pytest.mark.parametrize("name", ["turtlesim_challenge", "square"])
def test_every_check_tells_what_it_measures_and_every_tolerance_is_told(name):
    exercise = load_exercise(name)
    text = rubric(exercise)
    assert not re.search(r"\{\w", text)
    assert all(check.rubric for check in exercise.checks)
    told = " ".join(check.rubric for check in exercise.checks)
    untold = {key for key in exercise.tolerances if f"{{{key}" not in told}
    assert untold <= {"centres_m", "colours"}


def test_a_tolerance_that_was_edited_is_told_as_it_is_in_force(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text("exercise: turtlesim_challenge\ntolerances: {own_ink: 0.5}\n")
    assert "50 % or more" in rubric(load_exercise(path))
