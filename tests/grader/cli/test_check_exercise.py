import json
import os
import subprocess
import sys

import pytest

from grader.cli import main
from grader.recording.recording import Recordings
from grader.testing import checking
from tests.grader.driving import drive
from tests.grader.testing import exercises
from tests.programs import ROOT


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


def test_what_is_to_mend_is_named_with_exit_code_1(tmp_path, monkeypatch, capsys):
    still = Recordings(drive(lambda *_: None, ticks=100))
    run = lambda _, solutions, *__: {s.name: still for s in solutions} | {"again": still}  # noqa: E731
    monkeypatch.setattr(checking, "_run", run)
    monkeypatch.setattr(checking, "odd_recordings", lambda _: {})
    folder = exercises.write(tmp_path / "ahead", mutants={"right": {"solution": "solution.py"}})
    assert main(["check-exercise", str(folder)]) == 1
    said = " ".join(capsys.readouterr().out.split())
    for words in (
        "To fix: commands: a right solution loses points: 0 commands came. (on solution)",
        "To fix: there are no mutants in mutants.yaml",
    ):
        assert words in said


def test_what_cannot_be_used_ends_with_exit_code_2(tmp_path, capsys):
    assert main(["check-exercise", str(exercises.write(tmp_path, checks="def f(:\n"))]) == 2
    said, messages = capsys.readouterr()
    assert said == ""
    assert "checks.py, line 1: SyntaxError" in messages
    assert "Traceback" not in messages


@pytest.mark.parametrize("number", ["x", "0", "-1", "99999"])
def test_a_number_of_jobs_that_is_none_is_named(number, capsys):
    assert main(["check-exercise", "square", "--jobs", number]) == 2
    assert f"--jobs: expected a number of processes, found {number}" in capsys.readouterr().err
