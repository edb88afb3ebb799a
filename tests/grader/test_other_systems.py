"""Systems that are not Linux, as far as Linux can imitate them: gradings, and what they say.

What these systems really do has not been seen: docs/your-machine.md says what was run where.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import psutil
import pytest

from grader.run.processes.watched import await_ends
from tests.tiers import others_are_more

ROOT = Path(__file__).parents[2]
LACKING = Path(__file__).with_name("lacking.py")
#: One run that ends soon, in real time as well.
SHORT = """
exercise: turtlesim_challenge
points: {moves: 100}
limits: {first_motion_s: 8, rest_s: 0.2, total_s: 20}
varied_runs: {count: 0}
"""
DRIVES = """
import time
import rclpy
from geometry_msgs.msg import Twist
rclpy.init()
node = rclpy.create_node("driver")
publisher = node.create_publisher(Twist, "/turtle1/cmd_vel", 10)
twist = Twist()
twist.linear.x = 2.0
for _ in range(5):
    publisher.publish(twist)
    time.sleep(0.05)
"""


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


@pytest.fixture(params=["macos", "windows"])
def system(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def elsewhere(system: str, tmp_path: Path) -> Elsewhere:
    return Elsewhere(system, tmp_path)


KEPT_APART = {
    "macos": r"ROS domain \d+, process group",
    "windows": r"ROS domain \d+, process tree, recording within reach",
}


@pytest.mark.parametrize(
    ("system", "time"), [("macos", "virtual"), ("windows", "real")], indirect=["system"]
)
def test_a_submission_is_graded_and_the_result_says_how(elsewhere, system, time, tmp_path) -> None:
    (tmp_path / "short.yaml").write_text(SHORT)
    (tmp_path / "drives.py").write_text(DRIVES)
    words = ["drives.py", "--exercise", "short.yaml", "--time", time, "--out", "out"]
    done = elsewhere.run("-m", "grader", "run", *words, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    result = json.loads((tmp_path / "out" / "result.json").read_text())
    run = result["run"]
    assert result["score"] == 100
    assert run["time"] == "real"
    assert re.fullmatch(KEPT_APART[system], run["isolation"])
    lack = "virtual time needs /proc, which this system lacks"
    assert run["flags"] == ([f"graded in real time, because {lack}"] if time == "virtual" else [])


IMPORTS_ALL = """
import importlib, pkgutil, sys
import grader.cli, turtlesim_py
names = [m.name for m in pkgutil.walk_packages(turtlesim_py.__path__, "turtlesim_py.")]
names += ["grader", "grader.grading", "grader.run.simulator.real_time"]
names += [f"grader.cli.{m.name}" for m in pkgutil.iter_modules(grader.cli.__path__)]
for name in names:
    importlib.import_module(name)
print(len(names) > 20)
"""


def test_every_module_of_the_simulator_and_of_the_command_line_can_be_imported(elsewhere) -> None:
    done = elsewhere.run("-c", IMPORTS_ALL)
    assert (done.stdout, done.returncode) == ("True\n", 0), done.stderr


def test_the_teleop_says_what_is_missing(tmp_path: Path) -> None:
    done = Elsewhere("windows", tmp_path).run("-m", "turtlesim_py.programs.teleop_key")
    assert done.returncode == 2
    assert done.stderr.endswith(
        "turtle_teleop_key: this system has no termios, which gives single keys\n"
    )


def test_the_node_looks_for_arrivals_itself_where_rcl_has_another_name(tmp_path: Path) -> None:
    code = """
import rclpy
from turtlesim_py.ros.executor import TickExecutor
rclpy.init()
node = rclpy.create_node("node")
executor = TickExecutor(node)
executor.watch_arrivals()
print(executor._arrivals)
"""
    done = Elsewhere("macos", tmp_path).run("-c", code)
    assert done.stdout == "None\n", done.stderr


#: A submission that starts two programs: one in its family, one in a session of its own.
HAS_A_FAMILY = """
import subprocess, sys, time
for more in ({}, {"start_new_session": True}):
    print(subprocess.Popen(["sleep", "1000"], **more).pid, flush=True)
time.sleep(1000)
"""
ENDS_A_FAMILY = f"""
import os, sys
import psutil
from grader.run.processes.family import start_student
from grader.run.processes.watched import await_ends
student = start_student([sys.executable, "-c", {HAS_A_FAMILY!r}], os.environ)
while bytes(student._head).count(b"\\n") < 2:
    student.wait(0.02)
family = [psutil.Process(int(pid)) for pid in student.output().split()]
assert all(process.is_running() for process in family)
student.end(gently=sys.argv[1] == "gently")
left = await_ends(family, 20.0)
print(type(student).__name__, len(family), len(left), student.poll() is not None)
"""


@pytest.mark.parametrize(
    "how", others_are_more("a gentle end begins so", ["gently", "at once"], "at once")
)
def test_what_a_submission_starts_ends_with_its_run(elsewhere, how) -> None:
    done = elsewhere.run("-c", ENDS_A_FAMILY, how)
    assert done.stdout == "Unsupervised 2 0 True\n", done.stderr


def test_a_simulator_goes_when_the_grader_is_killed(elsewhere, tmp_path: Path) -> None:
    """Its parent's death is told by nobody, but the line to it ends."""
    code = """
import os, signal, sys
from grader.run import stage, simulator_process, real_time
from grader.run.plan import Plan
from grader.scenes.scene import Limits
plan = Plan(Limits(first_motion_s=1000, rest_s=1000, total_s=1000))
with stage.open_stage() as place:
    with simulator_process.start_simulator(real_time.MODULE, place, plan, None, '8') as simulator:
        simulator.expect("ready")
        print(simulator._process.pid, flush=True)
        os.kill(os.getpid(), 9)
"""
    done = elsewhere.run("-c", code)
    assert done.stdout, done.stderr
    with suppress(psutil.NoSuchProcess):
        assert not await_ends([psutil.Process(int(done.stdout))], 20.0)
