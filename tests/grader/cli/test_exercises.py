"""`grader exercises`: what is added is shown, asked for and tried, and offline from then on."""

from __future__ import annotations

import io
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from grader import cli, load_exercise
from grader.added import pins
from grader.cli import check_exercise, main
from grader.cli import exercises as cli_exercises
from grader.exercise.places import names
from grader.message import msg
from grader.testing.examination import Examination, Fault, Problem
from grader.testing.solutions import read_solutions
from tests.grader.added.repositories import commit, git
from tests.grader.testing import exercises

ROOT = Path(__file__).parents[3]
FINE = Examination("ahead", (), (), ())
TO_FIX = Examination("ahead", (), (), (Problem(Fault("", msg("nobody catches a mutant"))),))


@pytest.fixture(autouse=True)
def tried(monkeypatch, tmp_path):
    """The origins of what was tried; nothing is loaded for that, and all is fine."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    asked = []

    def trial(exercise, mutants=None, jobs=None):
        asked.append(origin_of(exercise))
        return FINE

    monkeypatch.setattr(cli_exercises, "load_exercise", lambda folder: folder)
    monkeypatch.setattr(check_exercise, "tried", trial)
    return asked


def origin_of(folder):
    pin = pins.around(folder)
    pin.check(folder)
    return pin.origin


@pytest.fixture
def repository(tmp_path):
    folder = exercises.write(tmp_path / "repository")
    commit(folder)
    git(folder, "tag", "v1")
    return folder


@pytest.fixture
def call(capsys):
    def called(*words):
        code = main(["exercises", *map(str, words)])
        out, err = capsys.readouterr()
        return code, out, " ".join(err.split())

    return called


def answering(monkeypatch, text):
    terminal = io.StringIO(text)
    terminal.isatty = lambda: True
    monkeypatch.setattr(sys, "stdin", terminal)


def test_what_is_added_is_shown_asked_tried_and_kept_for_offline_use(
    call, repository, monkeypatch, tried
):
    answering(monkeypatch, "y\n")
    code, out, _ = call("add", f"{repository}@v1")
    assert code == 0
    first = git(repository, "rev-parse", "HEAD")
    shown, _, rest = out.partition("Go on?")
    assert f"commit {first}" in shown
    assert "checks.py (" in shown
    assert "All is fine" in rest.partition("Trying it: ")[2]
    assert rest.endswith("Added: grader run SUBMISSION --exercise ahead\n")
    assert [each.commit for each in tried] == [first]
    shutil.rmtree(repository)
    assert load_exercise("ahead").origin == tried[0]
    assert "ahead" in names()


def test_nothing_is_added_without_a_yes(call, repository, monkeypatch, tried):
    code, out, err = call("add", repository)
    assert code == 2
    assert "checks.py (" in out
    assert "call again with --yes" in err
    for no in ("\n", ""):  # the latter is Ctrl-D
        answering(monkeypatch, no)
        code, out, _ = call("add", repository)
        assert (code, tried, pins.names()) == (1, [], [])
        assert out.endswith("Nothing was added.\n")


def test_nothing_is_added_in_which_there_is_something_to_fix(call, repository, monkeypatch):
    monkeypatch.setattr(check_exercise, "tried", lambda *_, **__: TO_FIX)
    code, out, _ = call("add", "--yes", repository)
    assert code == 1
    assert "To fix: nobody catches a mutant" in out
    assert pins.names() == []


def test_a_name_that_is_taken_is_refused_and_says_by_what(call, tmp_path, repository):
    assert call("add", repository, "--yes")[0] == 0
    code, _, err = call("add", repository, "--yes")
    assert code == 2
    assert "there is an exercise 'ahead' already, added from file://" in err
    assert "`grader exercises update ahead` fetches" in err
    other = exercises.write(tmp_path / "other")
    commit(other)
    assert "`grader exercises remove ahead` makes room" in call("add", other, "--yes")[2]
    folder = exercises.write(tmp_path / "square", exercise="square")
    commit(folder)
    code, _, err = call("add", folder, "--yes")
    assert code == 2
    assert "there is an exercise 'square' already, installed with a package" in err


def test_the_list_says_where_each_is_from_and_whether_it_is_unchanged(call, repository):
    assert "Added by address: none." in call("list")[1]
    call("add", repository, "--yes")
    out = call("list")[1]
    assert "  square (grader.exercises.square of turtlesim_py)\n" in out
    assert f"  ahead: {repository.as_uri()}\n" in out
    assert out.endswith(": unchanged\n")
    (pins.folder_of("ahead") / "checks.py").write_text("")
    assert "it is refused" in call("list")[1]
    (pins.folder_of("ahead").parent / "pin.json").write_text("x")
    code, out, _ = call("list")
    assert code == 0
    assert "cannot be used: " in out


def test_an_update_shows_what_changes(call, repository, tried):
    call("add", repository, "--yes")
    code, out, _ = call("update")
    assert (code, out) == (0, f"ahead is up to date: {repository.as_uri()}\n")
    first = git(repository, "rev-parse", "HEAD")
    (repository / "checks.py").write_text(exercises.CHECKS + "\n# more\n")
    (repository / "silent.py").rename(repository / "mute.py")
    second = commit(repository)
    code, out, err = call("update", "ahead")
    assert (code, origin_of(pins.folder_of("ahead")).commit) == (2, first)
    assert "--yes" in err
    code, out, _ = call("update", "--yes")
    assert code == 0
    assert f"until now: commit {first}\n    commit {second}" in out
    assert "    ~ checks.py\n    + mute.py\n    - silent.py\n" in out
    assert origin_of(pins.folder_of("ahead")).commit == second
    assert [each.commit for each in tried] == [first, second]


def test_an_update_takes_another_tag_as_add_says(call, repository):
    call("add", f"{repository}@v1", "--yes")
    (repository / "checks.py").write_text(exercises.CHECKS + "\n# more\n")
    second = commit(repository)
    git(repository, "tag", "v2")
    code, _, err = call("add", f"{repository}@v2", "--yes")
    assert code == 2
    assert "`grader exercises update ahead@v2` fetches what you ask for" in err
    code, out, _ = call("update", "ahead@v2", "--yes")
    assert code == 0
    assert f"The exercise ahead, from {repository.as_uri()}@v2\n    until now: " in out
    origin = origin_of(pins.folder_of("ahead"))
    assert (origin.commit, origin.tag) == (second, "v2")
    assert "up to date" in call("update", "ahead")[1]
    assert "update ahead@HEAD`" in call("add", repository, "--yes")[2]
    assert call("update", "ahead@HEAD", "--yes")[0] == 0
    assert "behind the @, found ''" in call("update", "ahead@", "--yes")[2]


def test_an_update_puts_back_what_was_changed_here(call, repository):
    call("add", repository, "--yes")
    (pins.folder_of("ahead") / "checks.py").write_text("")
    code, out, _ = call("update", "ahead", "--yes")
    assert code == 0
    assert "were changed here" in out
    assert origin_of(pins.folder_of("ahead")).address == repository.as_uri()


def test_an_update_is_of_the_same_exercise(call, repository):
    call("add", repository, "--yes")
    exercises.write(repository, exercise="behind")
    commit(repository)
    code, _, err = call("update", "--yes")
    assert code == 2
    assert "holds another exercise now, 'behind'" in err


def test_what_was_added_can_be_removed(call, repository):
    call("add", repository, "--yes")
    (pins.folder_of("ahead").parent / "pin.json").write_text("damaged")
    assert call("remove", "ahead")[:2] == (0, "Removed: ahead\n")
    assert "'ahead' is no added exercise; there is none" in call("remove", "ahead")[2]
    assert "pip uninstalls that" in call("remove", "square")[2]
    assert call("update", "ahead")[0] == 2


def test_an_exercise_without_a_name_is_refused(call, repository):
    (repository / "exercise.yaml").write_text("exercise: ../x\n")
    commit(repository)
    code, _, err = call("add", repository, "--yes")
    assert code == 2
    assert "expected a name such as my_exercise" in err


def test_no_message_names_the_folder_in_which_it_is_tried(call, repository, monkeypatch):
    monkeypatch.setattr(cli_exercises, "load_exercise", load_exercise)
    monkeypatch.setattr(check_exercise, "tried", lambda exercise, **_: read_solutions(exercise))
    (repository / "mutants.yaml").unlink()
    commit(repository)
    code, _, err = call("add", repository, "--yes")
    assert code == 2
    assert "'ahead', mutants.yaml: No such file" in err
    assert "--mutants" not in err
    (repository / "checks.py").unlink()
    commit(repository)
    err = call("add", repository, "--yes")[2]
    assert f"{repository.as_uri()} is not an exercise: it has no checks.py" in err
    exercises.write(repository, points=3)
    commit(repository)
    err = call("add", repository, "--yes")[2]
    assert f"{repository.as_uri()} is not an exercise: exercise.yaml, line" in err


def test_elsewhere_than_on_linux_it_lists_and_removes(call, repository, monkeypatch):
    call("add", repository, "--yes")
    monkeypatch.setattr(cli.system, "runs_submissions", lambda: False)
    assert call("update")[0] == 2
    assert "ahead" in call("list")[1]
    assert call("remove", "ahead")[0] == 0


def test_an_error_is_written_as_data_wherever_the_option_stands(call, tmp_path):
    for words in (
        ("--error-json", tmp_path / "e.json", "remove", "no"),
        ("remove", "no", "--error-json", tmp_path / "e.json"),
    ):
        assert call(*words)[0] == 2
        assert json.loads((tmp_path / "e.json").read_text())["whose"] == "call"
        (tmp_path / "e.json").unlink()


@pytest.mark.more("each judging of its solutions takes a process")
def test_it_is_really_tried_and_then_grades(repository, tmp_path):
    def called(*words):
        return subprocess.run(
            [sys.executable, "-m", "grader", *map(str, words)],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            capture_output=True,
            text=True,
        )

    done = called("exercises", "add", "--yes", repository)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "All is fine: 2 checks, 2 mutants, each caught." in done.stdout
    solution = repository / "solution.py"
    done = called("run", solution, "--exercise", "ahead", "--out", "graded", "--fail-under", "10")
    assert done.returncode == 0, done.stdout + done.stderr
    judged = json.loads((tmp_path / "graded" / "result.json").read_text())["provenance"]["judged"]
    assert judged["exercise_from"]["address"] == repository.as_uri()
    assert "The exercise is from" in (tmp_path / "graded" / "report.html").read_text()
