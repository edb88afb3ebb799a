"""Systems that are not Linux, as far as Linux can imitate them: what works there, what does not.

What these systems really do has not been seen: docs/your-machine.md says what was run where.
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import grader
from tests import archive
from tests.tiers import others_are_more

ROOT = Path(__file__).parents[2]
LACKING = Path(__file__).with_name("lacking.py")
SYSTEMS = others_are_more("Windows lacks all that macOS does", ("macos", "windows"), "windows")


class Elsewhere:
    """Python on a system that lacks something."""

    def __init__(self, system: str, folder: Path) -> None:
        self._python = folder / "python"
        words = shlex.join([sys.executable, str(LACKING), system, str(self._python)])
        self._python.write_text(f'#!/bin/sh\nexec {words} "$@"\n')
        self._python.chmod(0o755)
        # the folders of a grader that is killed go with the test's
        self._env = {**os.environ, "TMPDIR": str(folder)}

    def run(self, *words: str, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
        command = [str(self._python), *words]
        return subprocess.run(
            command, capture_output=True, text=True, check=False, cwd=cwd, env=self._env
        )


@pytest.fixture(params=SYSTEMS)
def elsewhere(request, tmp_path):
    return Elsewhere(request.param, tmp_path)


@pytest.mark.parametrize("verb", ["run", "check-exercise"])
def test_what_runs_submissions_says_that_it_needs_linux(elsewhere, verb, tmp_path):
    done = elsewhere.run("-m", "grader", verb, "drives.py", cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith(f"grader {verb}: submissions are run on Linux with /proc")
    assert "Traceback" not in done.stderr


def test_a_recording_is_judged_again_as_on_linux(elsewhere, tmp_path):
    shutil.copytree(archive.folder("talker", "wrong"), tmp_path / "recording")
    words = ["recording", "--exercise", "talker", "--json", "again.json"]
    done = elsewhere.run("-m", "grader", "check", *words, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    again = grader.Result.read(tmp_path / "again.json")
    assert again.verdicts == archive.result("talker", "wrong").verdicts


IMPORTS_ALL = """
import importlib, pkgutil, sys
import grader.cli, turtlesim_py
names = [m.name for m in pkgutil.walk_packages(turtlesim_py.__path__, "turtlesim_py.")]
names += ["grader", *(f"grader.cli.{each}" for each in ("check", "view", "report", "new"))]
for name in names:
    importlib.import_module(name)
print(len(names) > 20)
"""


def test_the_simulator_and_what_judges_and_shows_recordings_can_be_imported(elsewhere):
    done = elsewhere.run("-c", IMPORTS_ALL)
    assert (done.stdout, done.returncode) == ("True\n", 0), done.stderr


def test_the_teleop_says_what_is_missing(tmp_path):
    # as the installed command does: what is run with -m is __main__, whose imports are Python's
    command = "import sys; from turtlesim_py.programs.teleop_key import main; sys.exit(main())"
    done = Elsewhere("windows", tmp_path).run("-c", command)
    assert done.returncode == 2
    assert done.stderr.endswith(
        "turtle_teleop_key: this system has no termios, which gives single keys\n"
    )
