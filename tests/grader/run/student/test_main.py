"""In real time: what drives the scene is connected, and a program starts as on a desk."""

import json
import subprocess
import sys
import types
from pathlib import Path

import pytest

from grader.run.student import main
from grader.run.student.loading import ProgramStart
from tests.programs import ran

MAIN = main.__file__
PROGRAMS = """
import os, sys

def says():
    found = [name in sys.modules for name in (__name__, "main", "grader", "rclpy")]
    sys.stdout.write(f"arguments: {sys.argv[1:]} {found}" + os.linesep)

def fails():
    raise RuntimeError("broken")

class Node:
    main = staticmethod(says)
"""


@pytest.fixture
def clock(monkeypatch, wall_clock):
    monkeypatch.setattr(main, "time", wall_clock)
    return wall_clock


def patched(clock, connected_s: float) -> type:
    """A node class whose publishers are connected at a time [s]."""

    class Node:
        def create_publisher(self, kind: object, name: str) -> types.SimpleNamespace:
            count = lambda: int(clock.now_s >= connected_s)  # noqa: E731
            return types.SimpleNamespace(topic_name=name, get_subscription_count=count)

        def create_client(self, kind: object, name: str) -> None:
            raise AssertionError

    main.Introduced(["/turtle1/cmd_vel"], []).patch(types.SimpleNamespace(Node=Node))
    return Node


@pytest.mark.parametrize(
    ("name", "waited_s"), [("/turtle1/cmd_vel", 8), ("/turtle/cmd_vel", 4), ("/other", 0)]
)
def test_a_name_that_is_there_is_waited_for_longer_than_one_that_may_be_wrong(
    clock, name, waited_s
):
    patched(clock, connected_s=8.0)().create_publisher(object, name)
    assert clock.now_s == pytest.approx(waited_s, abs=0.1)


def test_names_that_may_be_wrong_are_waited_for_together(clock):
    node = patched(clock, connected_s=1000.0)()
    for _ in range(10):
        node.create_publisher(object, "/turtle/cmd_vel")
    assert clock.now_s == pytest.approx(4.0, abs=0.1)


def start(
    folder: Path, name: str, *arguments: str, module: str = "programs"
) -> subprocess.CompletedProcess[str]:
    (folder / f"{module}.py").write_text(PROGRAMS)
    program = ProgramStart(str(folder), module, name, arguments)
    words = ["-1", "[[], []]", json.dumps(program)]
    return ran([sys.executable, MAIN, *words])


@pytest.mark.parametrize("name", ["says", "Node.main"])
def test_a_program_gets_its_arguments_and_finds_nothing_of_ours(tmp_path, name):
    run = start(tmp_path, name, "--ros-args", "-r", "__ns:=/a")
    assert run.returncode == 0, run.stderr
    said = "arguments: ['--ros-args', '-r', '__ns:=/a'] [True, False, False, False]"
    assert run.stdout.splitlines() == [said]


def test_one_that_fails_is_told_without_our_lines(tmp_path):
    run = start(tmp_path, "fails")
    assert run.returncode == 1
    assert "RuntimeError: broken" in run.stderr
    assert MAIN not in run.stderr


def test_a_module_that_is_not_the_submission_s_is_named(tmp_path):
    run = start(tmp_path, "says", module="signal")
    assert run.returncode == 1
    assert "'signal' is also the name of a module" in run.stderr
