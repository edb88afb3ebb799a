"""A course's secret gives each student varied runs of his own, and no result shows the seed."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml

from grader.cli import main
from grader.exercise.loading import load_exercise

QUICK = Path(__file__).parents[2] / "submissions" / "quick_spiral.py"
SECRET = "what nobody in this course can guess"


@pytest.fixture
def secret(tmp_path):
    """The file of a course's secret."""
    path = tmp_path / "secret"
    path.write_text(SECRET + "\n")
    return path


@pytest.fixture
def exercise(tmp_path):
    """The challenge with one short varied run."""
    path = tmp_path / "short.yaml"
    short = {"limits": {"total_s": 3}, "varied_runs": {"count": 1}}
    path.write_text(yaml.safe_dump({"exercise": "turtlesim_challenge", **short}))
    return path


def graded(submission, out, exercise, *words):
    assert (
        main(["run", str(submission), "--exercise", str(exercise), "--out", str(out), *words]) == 0
    )
    return json.loads((out / "result.json").read_text())


def test_each_submission_starts_elsewhere_and_the_seed_stands_nowhere(tmp_path, secret, exercise):
    starts = []
    for name in ("ann", "bob"):
        submission = tmp_path / f"{name}.py"
        submission.write_bytes(QUICK.read_bytes())
        out = tmp_path / f"out_{name}"
        result = graded(submission, out, exercise, "--seed-file", str(secret))
        starts.append(result["varied_runs"][0]["start"])
        seed = str(load_exercise(str(exercise)).seed_for(name, SECRET))
        for file in filter(Path.is_file, out.rglob("*")):
            assert seed.encode() not in file.read_bytes(), file
    assert starts[0] != starts[1]


def test_from_its_day_on_the_seed_is_shown(tmp_path, secret, exercise):
    words = ("--seed-file", str(secret), "--seed-shown-from", "2020-01-01")
    result = graded(QUICK, tmp_path / "out", exercise, *words)
    seed = load_exercise(str(exercise)).seed_for(QUICK.stem, SECRET)
    assert result["provenance"]["recorded"]["seed"] == seed


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--seed-shown-from", "2027-01-01"], "--seed-shown-from is for --seed-file"),
        (["--seed-file", "short"], "expected 16 characters or more"),
        (["--seed-file", "missing"], "cannot read missing"),
        (["--seed-file", "short", "--seed", "1"], "not allowed with argument"),
        (["--seed-file", "short", "--seed-shown-from", "May"], "expected a date"),
    ],
)
def test_what_cannot_be_meant_is_refused(tmp_path, monkeypatch, capsys, words, told):
    monkeypatch.chdir(tmp_path)
    Path("short").write_text("1234")
    assert main(["run", str(QUICK), *words]) == 2
    assert told in " ".join(capsys.readouterr().err.split())
