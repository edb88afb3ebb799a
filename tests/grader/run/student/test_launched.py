"""Several programs of a submission are processes of their own, and end as one."""

import json
import signal
import subprocess
import sys
from pathlib import Path

from grader.run.student import main as student_main

LAUNCHED = Path(student_main.__file__).with_name("launched.py")
PROGRAMS = """
import os, signal, sys

def says():
    found = [name in sys.modules for name in (__name__, "main", "grader", "rclpy")]
    sys.stdout.write(f"arguments: {sys.argv[1:]} {found}" + os.linesep)

def fails():
    print("pid", os.getpid())
    raise RuntimeError("broken")

def killed():
    signal.raise_signal(signal.SIGTERM)
"""


def launch(folder: Path, *programs: tuple[str, list[str]]) -> subprocess.CompletedProcess[str]:
    (folder / "programs.py").write_text(PROGRAMS)
    listed = [[name, f"programs:{name}", arguments] for name, arguments in programs]
    words = [json.dumps([[], []]), "-1", str(folder), json.dumps(listed)]
    return subprocess.run(
        [sys.executable, LAUNCHED, *words], capture_output=True, text=True, check=False
    )


def test_each_gets_its_arguments_and_finds_nothing_of_ours(tmp_path: Path) -> None:
    run = launch(tmp_path, ("says", ["--ros-args", "-r", "__ns:=/a"]), ("says", []))
    assert run.returncode == 0, run.stderr
    assert sorted(run.stdout.splitlines()) == [
        "arguments: ['--ros-args', '-r', '__ns:=/a'] [True, False, False, False]",
        "arguments: [] [True, False, False, False]",
    ]


def test_one_that_fails_is_told_and_the_others_are_waited_for(tmp_path: Path) -> None:
    run = launch(tmp_path, ("fails", []), ("says", []))
    assert run.returncode == 1
    assert "arguments: []" in run.stdout
    assert "RuntimeError: broken" in run.stderr
    assert "fails has ended with exit code 1" in run.stderr
    assert str(LAUNCHED) not in run.stderr


def test_one_that_is_killed_is_as_if_all_had_been(tmp_path: Path) -> None:
    run = launch(tmp_path, ("killed", []), ("says", []))
    assert run.returncode == -signal.SIGTERM
