import json
from pathlib import Path

import pytest

from grader.cli import main
from grader.exercise.loading import load_exercise

SECRET = "what nobody in this course can guess"
CHALLENGE = load_exercise("turtlesim_challenge")


@pytest.fixture
def graded(tmp_path, node, in_no_time):
    """Grade by a course's secret; the folder of the result, and the result."""
    (tmp_path / "secret").write_text(SECRET + "\n")

    def call(name, *words):
        submission = node.rename(node.with_name(f"{name}.py"))
        out = tmp_path / name
        words = ["run", str(submission), "--out", str(out), "--seed-file", "secret", *words]
        assert main(words) == 0
        submission.rename(node)
        return out, json.loads((out / "result.json").read_text())

    return call


def test_each_submission_starts_elsewhere_and_the_seed_stands_nowhere(graded):
    starts = []
    for name in ("ann", "bob"):
        out, result = graded(name)
        starts.append(result["varied_runs"][0]["start"])
        seed = str(CHALLENGE.seed_for(name, SECRET))
        for file in filter(Path.is_file, out.rglob("*")):
            assert seed.encode() not in file.read_bytes(), file
    assert starts[0] != starts[1]


def test_from_its_day_on_the_seed_is_shown(graded):
    _, result = graded("ann", "--seed-shown-from", "2020-01-01")
    assert result["provenance"]["recorded"]["seed"] == CHALLENGE.seed_for("ann", SECRET)


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
def test_what_cannot_be_meant_is_refused(node, capsys, words, told):
    Path("short").write_text("1234")
    assert main(["run", "node.py", *words]) == 2
    assert told in " ".join(capsys.readouterr().err.split())
