import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from grader.cli import main
from tests.grader.cli.test_lazy import imported
from tests.grader.reports import samples

ROOT = Path(__file__).parents[3]


@pytest.fixture
def result(tmp_path):
    path = tmp_path / "result.json"
    path.write_text(json.dumps(samples.result(submission="größe.py")))
    return path


def test_without_a_format_it_is_for_the_terminal_and_a_folder_stands_for_its_result(result, capsys):
    assert main(["report", str(result)]) == main(["report", str(result.parent)]) == 0
    nothing, once, again = capsys.readouterr().out.split("Fix this first: Rationale of draws.\n")
    assert nothing == "" and once == again


def test_a_format_goes_to_standard_output_or_to_a_file(result, tmp_path, capsysbinary):
    assert main(["report", str(result), "--format", "gradescope"]) == 0
    assert json.loads(capsysbinary.readouterr().out)["score"] == 18.33
    out = tmp_path / "new" / "report.html"
    assert main(["report", str(result), "--format", "html", "--out", str(out)]) == 0
    assert out.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")
    assert capsysbinary.readouterr().out == b""


def test_csv_takes_several_results_and_other_formats_refuse_them(result, tmp_path, capsys):
    several = ["report", str(result), str(result), "--format"]
    assert main([*several, "csv"]) == 0
    assert len(capsys.readouterr().out.splitlines()) == 3
    assert main([*several, "junit", "--out", str(tmp_path / "x")]) == 2
    said = "junit shows one result, found 2; several can be given with: csv\n"
    assert capsys.readouterr().err.endswith(said)
    assert not (tmp_path / "x").exists()


def test_a_github_summary_is_appended_beside_the_usual_output(
    result, tmp_path, monkeypatch, capsys
):
    summary = tmp_path / "summary.md"
    summary.write_text("before\n")
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(summary))
    assert main(["report", str(result), "--format", "markdown"]) == 0  # unasked
    assert summary.read_text() == "before\n"
    assert main(["report", str(result), "--github-summary"]) == 0
    text = summary.read_text(encoding="utf-8")
    assert text.startswith("before\n## some\\_exercise: 18.33 of 40 points\n")
    assert "Score: 18.33 of 40" in capsys.readouterr().out
    monkeypatch.delenv("GITHUB_STEP_SUMMARY")
    assert main(["report", str(result), "--github-summary"]) == 2
    assert "GITHUB_STEP_SUMMARY is not set" in capsys.readouterr().err


def test_an_ascii_terminal_and_a_closed_pipe_are_no_failures(result):
    command = f"{sys.executable} -m grader report {result} --format html | head -c 10"
    env = {**os.environ, "PYTHONPATH": str(ROOT), "LC_ALL": "POSIX", "PYTHONUTF8": "0"}
    done = subprocess.run(
        ["bash", "-o", "pipefail", "-c", command], capture_output=True, text=True, env=env
    )
    assert done.stdout == "<!DOCTYPE "
    assert done.stderr == ""


def test_who_handed_in_what_cannot_be_used_has_a_row_in_the_table_of_a_class(tmp_path, capsys):
    """As docs/reports.md has it: beside where the result would be, found with the results."""
    for name in ("alice", "bob"):
        (tmp_path / "in" / name).mkdir(parents=True)
        words = ["--out", str(tmp_path / name), "--error-json", str(tmp_path / name / "error.json")]
        assert main(["run", str(tmp_path / "in" / name), *words]) == 2
    files = sorted(map(str, tmp_path.glob("*/*.json")))
    table = tmp_path / "class.csv"
    assert main(["report", *files, "--format", "csv", "--out", str(table)]) == 0
    rows = table.read_text().splitlines()[1:]
    assert [row.split(",")[:4] for row in rows] == [
        ["alice", "", "0", "100"],
        ["bob", "", "0", "100"],
    ]
    assert "alice is an empty folder" in rows[0]


def test_a_table_of_results_needs_no_terminal_and_no_page(tmp_path):
    result = tmp_path / "result.json"
    result.write_text(json.dumps(samples.result()))
    modules = imported("report", result, "--format", "csv", "--out", tmp_path / "results.csv")
    assert (tmp_path / "results.csv").exists()
    assert not {"rich", "jinja2", "backports"} & modules
