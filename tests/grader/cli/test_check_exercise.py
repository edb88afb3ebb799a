"""`grader check-exercise`, with real runs: an exercise in order, one to mend, one of no use."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
import yaml

from grader.cli import main
from tests.grader.testing import exercises

ROOT = Path(__file__).parents[3]


@pytest.fixture
def check(monkeypatch, capsys):
    """Calls it in this process, in the exercise's parent folder."""

    def called(folder):
        monkeypatch.chdir(folder.parent)
        monkeypatch.setenv("COLUMNS", "100")
        code = main(["check-exercise", folder.name])
        return code, *capsys.readouterr()

    return called


def test_an_exercise_in_order_gets_a_table_and_exit_code_0(tmp_path):
    folder = exercises.write(tmp_path / "ahead")
    done = subprocess.run(
        [
            *(sys.executable, "-m", "grader", "check-exercise", folder.name),
            *("--json", "it.json", "--markdown", "it.md"),
        ],
        cwd=folder.parent,
        env={**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "100"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.endswith("All is fine: 2 checks, 2 mutants, each caught.\n")
    assert sorted(line.split()[0] for line in done.stderr.splitlines()) == [
        *("1/4", "2/4", "3/4", "4/4")
    ]
    assert json.loads((tmp_path / "it.json").read_text())["catches"]["far"] == ["slow"]
    assert "| `slow` |" in (tmp_path / "it.md").read_text()
    assert not list(folder.rglob("*.pyc"))


def test_what_is_to_mend_is_named_with_exit_code_1(tmp_path, check):
    mutants = {"right": {"solution": "silent.py"}, "mutants": {"right": {"file": "solution.py"}}}
    code, said, _ = check(exercises.write(tmp_path / "ahead", mutants=mutants))
    assert code == 1
    for words in (
        "To fix: commands: a right solution loses points: 0 commands came. (on solution)",
        "To fix: nobody catches a mutant (on right)",
        "To fix: far: never fails on any mutant",
    ):
        assert words in said


def test_what_cannot_be_used_ends_with_exit_code_2(tmp_path, check):
    folder = exercises.write(tmp_path / "ahead", checks="def f(:\n")
    code, said, messages = check(folder)
    assert (code, said) == (2, "")
    assert "checks.py, line 1: SyntaxError" in messages
    assert "Traceback" not in messages


@pytest.mark.parametrize("number", ["x", "0", "-1", "99999"])
def test_a_number_of_jobs_that_is_none_is_named(number, capsys):
    assert main(["check-exercise", "square", "--jobs", number]) == 2
    assert f"--jobs: expected a number of processes, found {number}" in capsys.readouterr().err


def test_every_mutant_of_the_square_is_a_change_of_its_solution():
    text = (ROOT / "tests" / "grader" / "exercises" / "square_mutants.yaml").read_text(
        encoding="utf-8"
    )
    assert all("replace" in mutant for mutant in yaml.safe_load(text)["mutants"].values())
