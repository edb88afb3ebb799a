"""`grader run --watch` grades again after every save, and goes on after a mistake."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from argparse import Namespace
from dataclasses import replace
from pathlib import Path

import pytest
from rich.console import Console
from watchdog.events import (
    DirCreatedEvent,
    FileClosedEvent,
    FileCreatedEvent,
    FileDeletedEvent,
    FileModifiedEvent,
    FileMovedEvent,
    FileOpenedEvent,
)

from grader.cli.watch import Saves, change, each_save, grade_again
from grader.errors import UsageError
from grader.result.result import Result
from tests.grader.reports import samples

ROOT = Path(__file__).parents[3]


def test_a_save_is_graded_again_and_an_unusable_one_does_not_end_it(tmp_path):
    controller = tmp_path / "turtle_controller.py"
    controller.write_text("print('first')\n")
    with (tmp_path / "said.txt").open("w") as said:
        process = subprocess.Popen(
            [sys.executable, "-m", "grader", "run", str(controller), "--watch"],
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
        controller.write_text("print('second')\n")
        read_until(process, "Waiting for the next save")
        assert (result / "output.txt").read_text() == "second\n"
        controller.unlink()
        assert "does not exist" in read_until(process, "Waiting for the next save")
        controller.write_text("print('third')\n")
        read_until(process, "Waiting for the next save")
        assert (result / "output.txt").read_text() == "third\n"
        process.send_signal(signal.SIGINT)
        assert process.wait(timeout=30) == 130
        assert (tmp_path / "said.txt").read_text().count("  0, as before") == 2
        assert "\x1b" not in (tmp_path / "said.txt").read_text()
    finally:
        process.kill()
        process.communicate()


def read_until(process: subprocess.Popen[str], words: str) -> str:
    """What the process says until and with a line that holds the words."""
    assert process.stderr is not None
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


def test_an_echo_of_a_save_is_none(tmp_path, monkeypatch):
    controller = tmp_path / "turtle_controller.py"
    controller.touch()
    echo = FileModifiedEvent(str(controller))
    waited = []

    def wait(self):
        waited.append(self)
        if len(waited) == 1:
            self.on_any_event(echo)  # of what has been told of already
        else:
            controller.write_text("saved")

    monkeypatch.setattr(Saves, "wait", wait)
    saves = each_save(controller)
    next(saves)
    next(saves)
    assert len(waited) == 2


def test_an_editor_may_replace_the_file(tmp_path):
    controller = tmp_path / "turtle_controller.py"
    controller.touch()
    saves = each_save(controller)
    next(saves)
    (tmp_path / ".turtle_controller.py.swp").write_text("new")
    (tmp_path / ".turtle_controller.py.swp").replace(controller)
    next(saves)


def test_a_file_deep_in_a_package_counts(tmp_path):
    module = tmp_path / "package" / "package" / "node.py"
    module.parent.mkdir(parents=True)
    saves = each_save(tmp_path / "package")
    next(saves)
    module.write_text("saved")
    next(saves)


def test_a_folder_that_does_not_exist_cannot_be_watched(tmp_path):
    with pytest.raises(UsageError, match="missing does not exist"):
        next(each_save(tmp_path / "missing" / "turtle_controller.py"))


@pytest.fixture
def reported(monkeypatch):
    """Which of these events make a save: of the submission /home/a/pkg, or of one file in it."""

    def counted(*events, only=None):
        saves = Saves(Path("/home/a/pkg"), only, Path("/home/a/pkg/graded/turtle.py"))
        taken = []
        monkeypatch.setattr(saves, "_seen", type("Queue", (), {"put": taken.append}))
        for event in events:
            saves.dispatch(event)
        return taken

    return counted


@pytest.mark.parametrize(
    "event",
    [
        FileModifiedEvent("/home/a/pkg/pkg/node.py"),
        FileCreatedEvent("/home/a/pkg/setup.cfg"),
        FileDeletedEvent("/home/a/pkg/node.py"),
        FileMovedEvent("/home/a/pkg/node.py~", "/home/a/pkg/node.py"),
        FileModifiedEvent(b"/home/a/pkg/node.py"),
    ],
)
def test_what_can_change_a_verdict_is_a_save(reported, event):
    assert reported(event) == [event]


@pytest.mark.parametrize(
    "event",
    [
        FileOpenedEvent("/home/a/pkg/node.py"),
        FileClosedEvent("/home/a/pkg/node.py"),
        DirCreatedEvent("/home/a/pkg/graded/turtle_controller.py"),
        FileCreatedEvent("/home/a/pkg/graded/pkg/result.json"),
        FileCreatedEvent("/home/a/pkg/graded/pkg/report.html"),
        FileMovedEvent(
            "/home/a/pkg/graded/pkg/a", "/home/a/pkg/graded/pkg/recording/metadata.yaml"
        ),
        FileDeletedEvent("/home/a/pkg/graded/turtle.py"),
        FileModifiedEvent("/home/a/pkg/graded/turtle.py/node.py"),
        FileModifiedEvent("/home/a/pkg/__pycache__/node.py"),
        FileModifiedEvent("/home/a/pkg/.git/hooks/hook.py"),
        FileModifiedEvent("/home/a/pkg/.node.py.swp"),
    ],
)
def test_what_grading_reads_and_writes_is_no_save(reported, event):
    assert reported(event) == []


def test_of_a_single_file_its_neighbours_do_not_count(reported):
    own = FileModifiedEvent("/home/a/pkg/node.py")
    others = [FileModifiedEvent(f"/home/a/pkg/{name}") for name in ("other.py", "graded/node.py")]
    assert reported(own, *others, only="node.py") == [own]


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
