"""What `grader run` does while runs still go: here with runs that take as long as a test says."""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import threading
from dataclasses import replace
from pathlib import Path

import pytest

from grader import files, grading
from grader.cli import main
from grader.cli.grade_one import grade, out_of
from grader.errors import GraderFailure, UsageError
from grader.exercise.loading import load_exercise
from grader.recording import reading
from tests.grader.driving import Spiral, drive

ROOT = Path(__file__).parents[3]
#: `grader` whose runs take no time, for a reader that has gone.
READ_NO_MORE = """
import sys
from dataclasses import replace
from grader import grading
from grader.cli import main
from tests.grader.driving import Spiral, drive
drawn = drive(Spiral(), ticks=600)
grading.RUNNERS["virtual"] = lambda _, plan, progress=None: replace(drawn, start=plan.start)
sys.exit(main())
"""


@pytest.fixture(scope="module")
def drawn():
    return drive(Spiral(), ticks=600)


@pytest.fixture
def submission(tmp_path):
    path = tmp_path / "node.py"
    path.write_text("import turtlesim.msg")
    return path


@pytest.fixture
def call(submission, tmp_path):
    """The arguments of a call."""
    from grader.cli import _parser

    def called(*more: str):
        words = ["run", str(submission), "--out", str(tmp_path / "out"), *more]
        return _parser(words).parse_args(words)

    return called


@pytest.fixture(params=["nominal first", "varied first"])
def in_turn(monkeypatch, drawn, request):
    """Varied runs that are over only when the nominal one is, or the other way round."""
    is_over = threading.Event()

    def run(submission, plan, progress=None):
        if (plan.start is None) == (request.param == "nominal first"):
            is_over.set()
        assert is_over.wait(60)
        return replace(drawn, start=plan.start)

    monkeypatch.setitem(grading.RUNNERS, "virtual", run)


@pytest.mark.parametrize("words", [(), ("--watch",)])
def test_there_is_one_table(call, in_turn, capsys, words):
    assert grade(call(*words), None) == 0
    shown = capsys.readouterr()
    assert "nominal run" not in shown.err
    assert shown.out.count("Score: ") == 1


def test_recordings_are_complete_and_in_order_whichever_run_ends_first(call, in_turn, tmp_path):
    assert grade(call(), None) == 0
    loaded = reading.load_all(tmp_path / "out" / "recording")
    starts = [recording.start for recording in loaded]
    assert starts[0] is None
    assert starts[1:] == list(load_exercise("turtlesim_challenge").starts())


def test_a_run_that_cannot_be_made_leaves_an_older_recording_and_no_result(
    call, monkeypatch, drawn, tmp_path
):
    monkeypatch.setitem(grading.RUNNERS, "virtual", lambda *_: drawn)
    assert grade(call(), None) == 0
    out = tmp_path / "out"
    before = {path: path.read_bytes() for path in (out / "recording").rglob("*.*")}

    def fails(submission, plan, progress=None):
        if plan.start is not None:
            raise GraderFailure("the simulator died")
        return replace(drawn, output="newer")

    monkeypatch.setitem(grading.RUNNERS, "virtual", fails)
    with pytest.raises(GraderFailure, match="the simulator died"):
        grade(call(), None)
    assert not (out / "result.json").exists()
    assert {path: path.read_bytes() for path in (out / "recording").rglob("*.*")} == before


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


def hand_in_nothing(folder):
    (folder / "node.py").unlink()
    (folder / "node.py").mkdir()


@pytest.mark.parametrize(
    ("spoil", "whose"),
    [
        (hand_in_nothing, "submission"),
        (lambda folder: (folder / "mine.yaml").write_text("points: [1"), "exercise"),
        (lambda folder: (folder / "node.py").unlink(), "call"),
    ],
)
def test_a_call_that_is_refused_leaves_no_older_result(
    submission, monkeypatch, drawn, tmp_path, spoil, whose
):
    monkeypatch.setitem(
        grading.RUNNERS, "virtual", lambda _, plan, __=None: replace(drawn, start=plan.start)
    )
    (tmp_path / "mine.yaml").write_text("exercise: turtlesim_challenge")
    monkeypatch.chdir(tmp_path)
    words = "run node.py --exercise mine.yaml --out out --json copy.json --error-json error.json"
    results = [tmp_path / "out" / "result.json", tmp_path / "copy.json"]
    assert main(words.split()) == 0
    assert all(result.exists() for result in results)
    spoil(tmp_path)
    assert main(words.split()) == 2
    assert json.loads((tmp_path / "error.json").read_text())["whose"] == whose
    assert not any(result.exists() for result in results)


def test_ctrl_c_between_two_runs_leaves_nothing(submission, monkeypatch, drawn, tmp_path, capsys):
    def interrupted(submission, plan, progress=None):
        if plan.start is not None:
            raise KeyboardInterrupt
        return drawn

    monkeypatch.setitem(grading.RUNNERS, "virtual", interrupted)
    assert main(["run", str(submission), "--out", str(tmp_path / "out")]) == 130
    assert capsys.readouterr().err.endswith("grader run: interrupted\n")
    assert list((tmp_path / "out").iterdir()) == []


def test_who_grades_into_the_folder_of_another_grading_is_told_so(
    call, tmp_path, monkeypatch, drawn
):
    monkeypatch.setitem(grading.RUNNERS, "virtual", lambda *_: drawn)
    out = tmp_path / "out"
    out.mkdir()
    with (
        files.sole_writer(out),
        pytest.raises(UsageError, match="another grading writes into"),
    ):
        grade(call(), None)
    assert list(out.iterdir()) == []


def test_a_reader_that_has_seen_enough_does_not_change_the_exit_code(call, tmp_path):
    words = [sys.executable, "-c", READ_NO_MORE, *map(str, ("run", call().submission))]
    ours, theirs = os.pipe()
    os.close(ours)
    done = subprocess.run(
        [*words, "--out", str(tmp_path / "out")], stdout=theirs, stderr=subprocess.PIPE, cwd=ROOT
    )
    os.close(theirs)
    assert (done.returncode, b"Traceback" in done.stderr) == (0, False), done.stderr
