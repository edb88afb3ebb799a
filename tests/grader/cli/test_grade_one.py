"""What `grader run` does while runs still go: here with runs that take as long as a test says."""

import argparse
import json
import os
import subprocess
import sys
import threading
from dataclasses import replace
from pathlib import Path

import pytest

from grader import grading
from grader.cli import main
from grader.cli.grade_one import out_of
from grader.exercise.loading import load_exercise
from grader.recording import reading
from grader.system import files
from tests import archive
from tests.programs import ROOT

RUN = ["run", "node.py", "--out", "out"]


@pytest.mark.parametrize("nominal_first", [True, False])
def test_one_table_is_shown_and_recordings_are_in_order_whichever_run_ends_first(
    node, drawn, monkeypatch, capsys, nominal_first
):
    is_over = threading.Event()

    def run(submission, plan, progress=None):
        if (plan.start is None) == nominal_first:
            is_over.set()
        assert is_over.wait(60)
        return replace(drawn, start=plan.start)

    monkeypatch.setitem(grading.RUNNERS, "virtual", run)
    assert main(RUN) == 0
    shown = capsys.readouterr()
    assert "nominal run" not in shown.err
    assert shown.out.count("Score: ") == 1
    starts = [recording.start for recording in reading.load_all(Path("out/recording"))]
    assert starts == [None, *load_exercise("turtlesim_challenge").starts()]


def test_a_run_that_cannot_be_made_leaves_an_older_recording_and_no_result(
    node, in_no_time, drawn, monkeypatch, capsys
):
    assert main(RUN) == 0
    before = {path: path.read_bytes() for path in Path("out/recording").rglob("*.*")}

    def fails(submission, plan, progress=None):
        if plan.start is not None:
            raise OSError("the simulator died")
        return replace(drawn, output="newer")

    monkeypatch.setitem(grading.RUNNERS, "virtual", fails)
    assert main(RUN) == 3
    assert "the simulator died" in capsys.readouterr().err
    assert not Path("out/result.json").exists()
    assert {path: path.read_bytes() for path in Path("out/recording").rglob("*.*")} == before


@pytest.mark.parametrize(
    ("handed_in", "out"),
    [
        ("alice.py", "graded/alice.py"),
        ("subs/alice", "graded/subs/alice"),
        ("../elsewhere/bob.zip", "graded/elsewhere/bob.zip"),
        (".", "graded/{parent}/{here}"),
    ],
)
def test_every_submission_has_a_folder_for_its_result(tmp_path, monkeypatch, handed_in, out):
    monkeypatch.chdir(tmp_path)
    args = argparse.Namespace(out=None, submission=Path(handed_in))
    expected = out.format(parent=tmp_path.parent.name, here=tmp_path.name)
    assert out_of(args) == Path(expected)


def test_a_call_that_is_refused_leaves_no_older_result(node, in_no_time, tmp_path):
    mine = tmp_path / "mine.yaml"
    mine.write_text("exercise: turtlesim_challenge")
    words = "run node.py --exercise mine.yaml --out out --json copy.json --error-json error.json"
    results = [tmp_path / "out" / "result.json", tmp_path / "copy.json"]
    assert main(words.split()) == 0
    older = [result.read_bytes() for result in results]

    def refused(whose, max_score):
        for result, data in zip(results, older, strict=True):
            result.write_bytes(data)
        assert main(words.split()) == 2
        error = json.loads((tmp_path / "error.json").read_text())
        assert (error["whose"], error["max_score"]) == (whose, max_score)
        assert not any(result.exists() for result in results)

    node.unlink()
    refused("call", 100)
    node.mkdir()
    refused("submission", 100)
    mine.write_text("points: [1")
    refused("exercise", None)


def test_ctrl_c_between_two_runs_leaves_nothing_but_why(node, drawn, monkeypatch, tmp_path, capsys):
    def interrupted(submission, plan, progress=None):
        if plan.start is not None:
            raise KeyboardInterrupt
        return drawn

    monkeypatch.setitem(grading.RUNNERS, "virtual", interrupted)
    assert main([*RUN, "--error-json", "error.json"]) == 130
    assert capsys.readouterr().err.endswith("grader run: interrupted\n")
    assert list(Path("out").iterdir()) == []
    assert json.loads(Path("error.json").read_text())["message"] == "interrupted"


def test_who_grades_into_the_folder_of_another_grading_is_told_so(node, in_no_time, capsys):
    Path("out").mkdir()
    with files.sole_writer(Path("out")):
        assert main(RUN) == 2
    assert "another grading writes into" in capsys.readouterr().err
    assert list(Path("out").iterdir()) == []


def test_a_reader_that_has_seen_enough_does_not_change_the_exit_code():
    ours, theirs = os.pipe()
    os.close(ours)
    words = [sys.executable, "-m", "grader", "check", str(archive.folder("square", "wrong"))]
    done = subprocess.run(words, stdout=theirs, stderr=subprocess.PIPE, cwd=ROOT)
    os.close(theirs)
    assert (done.returncode, b"Traceback" in done.stderr) == (0, False), done.stderr
