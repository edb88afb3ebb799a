"""What a user's shell and `ros2 run` do, for the tests of installations."""

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from ament_index_python.packages import get_package_prefix

from grader.run.processes.network import reserve_domain
from tests.programs import ran

ROOT = Path(__file__).resolve().parents[2]

# Everything that an installation is made of.
SOURCES = (
    *("LICENSE", "MANIFEST.in", "README.md", "grader", "grader_class", "grader_diagnosis"),
    *("grader_robots", "interfaces", "launch", "package.xml", "pyproject.toml", "setup.py", "tf2"),
    *("ros_doubles", "turtlesim_challenge", "turtlesim_py"),
)

STARTED = "Starting turtlesim with node name /turtlesim"

Environment = dict[str, str]


class System:
    """A machine with few commands; `add` gives it more, or replaces one."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.env = {"PATH": str(folder)}

    def add(self, name: str, script: str = "") -> None:
        path = self.folder / name
        path.write_text(f"#!/bin/sh\n{script}\n")
        path.chmod(0o755)

    def check(self) -> subprocess.CompletedProcess[str]:
        script = ROOT / "scripts" / "check_setup.sh"
        return ran(["/bin/sh", script], env=self.env)


def copy_environment(folder: Path, *left_out: str) -> Path:
    """Copy this Python's environment into a folder, but for files and folders of these names.

    It is ten thousands of files, which pytest would keep: remove it.
    """

    def link(source: str, target: str) -> None:  # no symbolic one: a sandbox shows it alone
        try:
            os.link(source, target)
        except OSError:  # on another disk
            shutil.copy2(source, target)

    ignored, place = shutil.ignore_patterns(*left_out), folder / "environment"
    return shutil.copytree(sys.prefix, place, symlinks=True, ignore=ignored, copy_function=link)


@pytest.fixture
def shell():
    """A user's environment: not that of this Python, and on no one else's ROS graph."""
    env = dict(os.environ)
    if env.pop("_ROS_WHEELS_BOOTSTRAP_COMPLETE", None):
        env.pop("LD_LIBRARY_PATH", None)
    with reserve_domain() as number:
        yield env | {"ROS_DOMAIN_ID": str(number)}


def copy_sources(folder: Path) -> None:
    for name in SOURCES:
        if (ROOT / name).is_dir():
            ignored = shutil.ignore_patterns("__pycache__")
            shutil.copytree(ROOT / name, folder / name, ignore=ignored, symlinks=True)
        else:
            shutil.copy(ROOT / name, folder)


@pytest.fixture
def checkout(tmp_path):
    """A copy of the sources: a build writes beside them."""
    copy = tmp_path / "checkout"
    copy.mkdir()
    copy_sources(copy)
    return copy


def colcon_build(folder: Path, *options: object, **env: str) -> subprocess.CompletedProcess[str]:
    """`colcon build` in a folder."""
    places = (Path(sys.executable).parent, Path(os.__file__).parents[2] / "bin")
    colcon = shutil.which("colcon", path=os.pathsep.join([*map(str, places), os.environ["PATH"]]))
    assert colcon, "colcon is one of the `test` requirements"
    env |= {"COLCON_HOME": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    return ran([colcon, "build", *options], cwd=folder, env=os.environ | env)


@pytest.fixture
def ros2_run(monkeypatch):
    """Find a program as `ros2 run PACKAGE PROGRAM` does, which is not on PyPI."""

    def find(package: str, program: str, env: Environment) -> Path:
        monkeypatch.setenv("AMENT_PREFIX_PATH", env["AMENT_PREFIX_PATH"])
        path = Path(get_package_prefix(package), "lib", package, program)
        assert path.is_file(), f"ros2 run finds no {path}"
        assert os.access(path, os.X_OK), f"ros2 run leaves out {path}: not executable"
        return path

    return find


@pytest.fixture
def run_until_started():
    """Start the simulator, stop it as Ctrl-C does once it is there, and return what it said.

    Another node is there when it has said its `sign`.
    """

    def run(program: Path, env: Environment, sign: str = STARTED) -> str:
        process = subprocess.Popen(
            [program], env=env, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True
        )
        said = ""
        try:
            for line in process.stderr:
                said += line
                if sign in line:
                    process.send_signal(signal.SIGINT)
            assert process.wait() == 0, said
        finally:
            process.kill()
            process.wait()
            process.stderr.close()
        return said

    return run
