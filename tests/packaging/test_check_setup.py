"""scripts/check_setup.sh: one line says what to install, and the build does not start."""

import shutil
import sys
from pathlib import Path

import pytest

from tests.programs import ran

from .conftest import ROOT, System

PYTHON = str(Path(sys.executable).resolve())


@pytest.fixture
def system(tmp_path):
    """A machine on which everything is there."""
    system = System(tmp_path)
    system.add("uname", '[ "$1" = -s ] && echo Linux || echo x86_64')
    system.add("python3", f'exec {PYTHON} "$@"')
    return system


def without(name: str) -> str:
    """A Python that behaves as if code with `name` in it failed."""
    cases = [
        '*_base_executable*) echo "$0" ;;',
        f"*{name}*) exit 1 ;;",
        f'*) exec {PYTHON} "$@" ;;',
    ]
    return "\n".join(['case "$2" in', *cases, "esac"])


def test_prints_the_python_that_it_chose(system):
    result = system.check()
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.strip() == PYTHON


def test_the_python_that_is_asked_for_goes_first(system):
    system.add("python3", "exit 1")
    system.env["PYTHON"] = PYTHON
    assert system.check().stdout.strip() == PYTHON


def test_a_python_without_venv_is_no_use(system):
    system.add("python3", without("ensurepip"))
    assert f"apt install python3.{sys.version_info.minor}-venv" in system.complaint()


@pytest.mark.parametrize("version", ["3.10", "3.14", ""])
def test_no_python_fits(system, version):
    system.add("python3", f"echo {version}")
    line = system.complaint()
    assert "no Python 3.11, 3.12 or 3.13 found" in line
    assert f"python3 is {version or 'missing'}" in line


def test_the_python_that_is_asked_for_is_too_old(system):
    system.add("python3.8", "echo 3.8")
    system.env["PYTHON"] = "python3.8"
    assert "PYTHON=python3.8 is Python 3.8, needed is" in system.complaint()


def test_the_lower_bounds_are_older_than_the_newest_python(system):
    system.add("python3", "echo 3.13")
    system.add(
        "python3.12", f'case "$2" in *version_info*) echo 3.12 ;; *) exec {PYTHON} "$@" ;; esac'
    )
    system.env["BOUNDS"] = "lowest"
    assert system.check().stdout.strip() == PYTHON
    (system.folder / "python3.12").unlink()
    assert "no Python 3.11 or 3.12 found" in system.complaint()


def test_the_python_that_is_asked_for_is_not_there(system):
    system.env["PYTHON"] = "python4"
    assert "PYTHON=python4: no such command" in system.complaint()


def test_a_command_of_pyenv_without_its_version_does_not_count(system):
    system.add("python3.12", "echo 'pyenv: python3.12: command not found' >&2; exit 127")
    system.env["PYTHON"] = "python3.12"
    assert "PYTHON=python3.12 does not start" in system.complaint()


def test_ros_is_on_pypi_for_one_system_only(system):
    system.add("uname", '[ "$1" = -s ] && echo Darwin || echo arm64')
    line = system.complaint()
    assert "this is Darwin arm64" in line
    assert "install ROS 2 Jazzy" in line


def test_the_python_has_to_be_that_of_the_sourced_ros(system):
    system.add("python3", without("rclpy"))
    system.env["ROS_DISTRO"] = "jazzy"
    assert "cannot import its rclpy" in system.complaint()


@pytest.mark.parametrize("release", ["jazzy", "kilted", "lyrical"])
def test_these_releases_of_ros_may_be_sourced(system, release):
    system.add("python3", without("rclpy").replace("*rclpy*) exit 1", "*rclpy*) exit 0"))
    system.env["ROS_DISTRO"] = release
    assert system.check().returncode == 0


@pytest.mark.parametrize("release", ["humble", "rolling"])
def test_another_release_of_ros_is_refused(system, release):
    system.env["ROS_DISTRO"] = release
    expected = f"ROS 2 {release} is sourced, needed is Jazzy, Kilted or Lyrical"
    assert expected in system.complaint()


@pytest.mark.parametrize(
    ("release", "complaint"),
    [("jazzy", "no Python 3.11, 3.12 or 3.13 found"), ("lyrical", "ROS 2 lyrical is sourced, but")],
)
def test_the_python_of_ubuntu_26_04_is_for_lyrical(system, release, complaint):
    cases = ['*_base_executable*) echo "$0" ;;', "*version_info*) echo 3.14 ;;"]
    cases += ["*rclpy*) exit 1 ;;"]
    system.add("python3", "\n".join(['case "$2" in', *cases, "esac"]))
    system.env["ROS_DISTRO"] = release
    assert complaint in system.complaint()


def test_says_it_through_make(system):
    make, bash = shutil.which("make"), shutil.which("bash")
    assert make and bash
    system.env["ROS_DISTRO"] = "humble"
    for name in ("dirname", "flock", "cat", "bash", "env"):
        (system.folder / name).symlink_to(shutil.which(name) or name)
    copy = system.folder / "project"
    shutil.copytree(ROOT / "scripts", copy / "scripts")
    shutil.copy(ROOT / "Makefile", copy)
    result = ran([make, "-C", copy, "demo", f"SHELL={bash}"], env=system.env)
    assert result.returncode != 0
    assert "Cannot install: ROS 2 humble is sourced" in result.stderr
    assert not (copy / ".venv").exists()
