"""An environment in which nothing was compiled grades as one with compiled interfaces does."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.programs import ran
from turtlesim_py.ros import source

from .conftest import ROOT, Environment, copy_environment, copy_sources

pytestmark = [
    pytest.mark.applies("ROS_DISTRO" not in os.environ, reason="ROS's are compiled"),
    pytest.mark.more("an environment of its own"),
]
EXERCISES = ROOT / "grader" / "exercises"
REFERENCES = {
    "turtlesim_challenge": ROOT / "turtlesim_challenge" / "turtle_controller.py",
    "tf2_listener": EXERCISES / "tf2_listener" / "reference" / "tf2_listener.py",
    "action_server": EXERCISES / "action_server" / "reference" / "action_server.py",
    "catch_them_all": EXERCISES / "catch_them_all" / "reference",
}


@pytest.fixture(scope="module")
def environment(tmp_path_factory):
    """A copy of this one, but for what is compiled of ours."""
    folder = tmp_path_factory.mktemp("uncompiled")
    place = copy_environment(folder)
    copy_sources(folder)
    (release,) = source._brought()
    pip = ["-m", "pip", "install", "--no-build-isolation", "--no-deps", "--force-reinstall"]
    subprocess.run(
        [place / "bin" / "python", *pip, folder / "interfaces" / release],
        env=os.environ | {"COMPILE": ""},
        check=True,
    )
    yield place
    shutil.rmtree(folder)


def run(prefix: Path, *words: str | Path, env: Environment) -> subprocess.CompletedProcess[str]:
    """Run `grader run` in an environment."""
    command = [prefix / "bin" / "python", "-P", "-m", "grader", "run", *words]
    return ran(command, env=env)


@pytest.mark.parametrize("exercise", REFERENCES)
def test_a_grading_is_the_same(environment, shell, tmp_path, exercise):
    def graded(prefix: Path) -> dict[str, Any]:
        out = tmp_path / prefix.name
        words = (REFERENCES[exercise], "--exercise", exercise, "--out", out)
        done = run(prefix, *words, "--fail-under", "100", env=shell)
        assert done.returncode == 0, done.stderr
        result: dict[str, Any] = json.loads((out / "result.json").read_text())
        runs = (result["run"], *result["varied_runs"])
        same = ("time", "outcome", "flags", "trace_sha256")
        return {
            "verdicts": result["verdicts"],
            "runs": [{name: each[name] for name in same} for each in runs],
        }

    made, compiled = graded(environment), graded(Path(sys.prefix))
    assert {each["time"] for each in made["runs"]} == {"virtual"}
    assert made == compiled


def test_what_needs_compiled_ones_says_so_in_one_line(environment, shell):
    sentence = "turtlesim's interfaces are installed as definitions only"
    start = "import sys; from turtlesim_py import commands; sys.exit(commands.turtlesim_node())"
    node = ran([environment / "bin" / "python", "-P", "-c", start], env=shell)
    real = run(environment, REFERENCES["turtlesim_challenge"], "--time", "real", env=shell)
    for command, done in (("turtlesim_node", node), ("grader run", real)):
        assert done.returncode == 2
        (line,) = done.stderr.splitlines()
        assert line.startswith(f"{command}: {sentence}")
        assert "sudo apt install build-essential" in line
