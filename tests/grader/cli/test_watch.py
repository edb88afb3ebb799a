import os
import signal
import subprocess
import sys
from argparse import Namespace
from dataclasses import replace

import pytest
from rich.console import Console

from grader.cli import watch
from grader.cli.watch import change, each_save, grade_again
from grader.errors import UsageError
from grader.exercise.result.result import Result
from tests.grader.cli.test_live import ONE_RUN
from tests.grader.reports import samples
from tests.programs import ROOT


def test_a_save_is_graded_again_and_an_unusable_one_does_not_end_it(tmp_path):
    controller = tmp_path / "turtle_controller.py"
    controller.write_text("print('first')\n")
    (tmp_path / "one_run.yaml").write_text(ONE_RUN)
    words = ["run", str(controller), "--watch", "--exercise", "one_run.yaml"]
    with (tmp_path / "said.txt").open("w") as said:
        process = subprocess.Popen(
            [sys.executable, "-m", "grader", *words],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            stdout=said,
            stderr=subprocess.PIPE,
            text=True,
        )
    try:
        read_until(process, "Waiting for the next save")
        result = tmp_path / "graded" / "turtle_controller.py"
        assert (result / "output.txt").read_text() == "first\n"
        controller.unlink()
        assert "does not exist" in read_until(process, "Waiting for the next save")
        controller.write_text("print('second')\n")
        read_until(process, "Waiting for the next save")
        assert (result / "output.txt").read_text() == "second\n"
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=30) == 130
        assert (tmp_path / "said.txt").read_text().count("  0, as before") == 1
        assert "\x1b" not in (tmp_path / "said.txt").read_text()
    finally:
        process.kill()
        process.communicate()


def read_until(process, words):
    """What the process says until and with a line that holds the words."""
    said = ""
    for line in process.stderr:
        said += line
        if words in line:
            return said
    raise AssertionError(f"it ended without saying {words!r}: {said}")


def test_a_save_while_the_caller_is_busy_is_not_lost(tmp_path):
    controller = tmp_path / "turtle_controller.py"
    controller.touch()
    saves = each_save(controller)
    next(saves)
    for _ in range(2):
        controller.write_text("saved while busy")
        next(saves)


def test_a_save_is_over_when_the_files_are_the_same_twice(tmp_path, monkeypatch):
    controller = tmp_path / "turtle_controller.py"
    controller.touch()
    texts = ["one half", "one half, and the other"]
    waited = []

    def sleep(_):
        waited.append(controller.read_text())
        if texts:
            controller.write_text(texts.pop(0))

    monkeypatch.setattr(watch.time, "sleep", sleep)
    saves = each_save(controller)
    next(saves)
    next(saves)
    assert waited == ["", "one half", "one half, and the other"]


def test_an_editor_may_replace_a_file_also_one_deep_in_a_package(tmp_path):
    module = tmp_path / "package" / "node.py"
    module.parent.mkdir()
    module.touch()
    saves = each_save(tmp_path)
    next(saves)
    (tmp_path / ".node.py.swp").write_text("new")
    (tmp_path / ".node.py.swp").replace(module)
    next(saves)


def test_a_folder_that_does_not_exist_cannot_be_watched(tmp_path):
    with pytest.raises(UsageError, match="missing does not exist"):
        next(each_save(tmp_path / "missing" / "turtle_controller.py"))


def test_what_can_change_a_verdict_counts_and_not_what_grading_and_others_leave(tmp_path):
    counts = ("pkg/node.py", "setup.cfg", "package.xml", "pkg/inner/new.py")
    others = (
        "graded/pkg/result.json",
        "graded/pkg/recording/metadata.yaml",
        "graded/turtle.py/node.py",
        "pkg/__pycache__/node.py",
        ".git/hooks/hook.py",
        "pkg/.node.py.swp",
    )
    assert counted(tmp_path, *counts, *others) == {tmp_path / name for name in counts}


def test_of_a_single_file_its_neighbours_do_not_count(tmp_path):
    names = ("node.py", "other.py", "graded/node.py")
    assert counted(tmp_path, *names, only="node.py") == {tmp_path / "node.py"}


def counted(folder, *names, only=None):
    """Which of these files count, of a folder or of one file in it."""
    for path in (folder / name for name in names):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    return set(watch.state(folder, only, folder / "graded" / "turtle.py"))


@pytest.mark.parametrize(
    ("last", "score", "said"),
    [
        (None, 62.0, "62 of 100"),
        (62.0, 80.0, "62 -> 80 (+18)"),
        (80.0, 71.5, "80 -> 71.5 (-8.5)"),
        (80.0, 80.0, "80, as before"),
    ],
)
def test_a_score_is_compared_with_the_last_one(last, score, said):
    first = Result.from_json(samples.result())
    made = [s if s is None else replace(first, score=s, max_score=100.0) for s in (last, score)]
    assert change(*made) == said


def test_the_screen_is_cleared_before_the_second_time_and_only_on_a_terminal(monkeypatch):
    made = Result.from_json(samples.result())
    monkeypatch.setattr("grader.cli.grade_one.graded", lambda args, live: made)
    for is_terminal in (True, False):
        cleared = []
        monkeypatch.setattr(Console, "is_terminal", is_terminal)
        monkeypatch.setattr(Console, "clear", lambda self, cleared=cleared: cleared.append(1))
        for number, expected in enumerate((0, is_terminal)):
            grade_again(Namespace(error_json=None), None, None, clears=number > 0)
            assert len(cleared) == expected
