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


def choosing(*cases: str) -> str:
    """A Python that answers code with a word in it otherwise than by running it."""
    return "\n".join(['case "$2" in', '*_base_executable*) echo "$0" ;;', *cases, "esac"])


def without(name: str) -> str:
    """A Python that behaves as if code with `name` in it failed."""
    return choosing(f"*{name}*) exit 1 ;;", f'*) exec {PYTHON} "$@" ;;')


NEWEST = choosing("*version_info*) echo 3.14 ;;", "*rclpy*) exit 1 ;;")


def test_prints_the_python_that_it_chose(system):
    result = system.check()
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.strip() == PYTHON


def test_the_python_that_is_asked_for_goes_first(system):
    system.add("python3", "exit 1")
    system.env["PYTHON"] = PYTHON
    assert system.check().stdout.strip() == PYTHON


#: What the commands are, the variables that are set, and what is complained of.
COMPLAINTS = [
    ({"python3": without("ensurepip")}, {}, f"apt install python3.{sys.version_info.minor}-venv"),
    ({"python3": "echo 3.10"}, {}, "no Python 3.11, 3.12 or 3.13 found (python3 is 3.10"),
    ({"python3": "echo 3.14"}, {}, "python3 is 3.14"),
    ({"python3": "echo"}, {}, "python3 is missing"),
    (
        *({"python3.8": "echo 3.8"}, {"PYTHON": "python3.8"}),
        "PYTHON=python3.8 is Python 3.8, needed is",
    ),
    ({}, {"PYTHON": "python4"}, "PYTHON=python4: no such command"),
    (  # of pyenv, without that version
        {"python3.12": "echo 'pyenv: python3.12: command not found' >&2; exit 127"},
        *({"PYTHON": "python3.12"}, "PYTHON=python3.12 does not start"),
    ),
    (
        *({"uname": '[ "$1" = -s ] && echo Darwin || echo arm64'}, {}),
        "this is Darwin arm64, but ROS 2 is on PyPI for Linux x86_64 only: install ROS 2 Jazzy",
    ),
    ({"python3": without("rclpy")}, {"ROS_DISTRO": "jazzy"}, "cannot import its rclpy"),
    *(
        ({}, {"ROS_DISTRO": name}, f"ROS 2 {name} is sourced, needed is Jazzy, Kilted or Lyrical")
        for name in ("humble", "rolling")
    ),
    # the Python of Ubuntu 26.04
    ({"python3": NEWEST}, {"ROS_DISTRO": "jazzy"}, "no Python 3.11, 3.12 or 3.13 found"),
    ({"python3": NEWEST}, {"ROS_DISTRO": "lyrical"}, "ROS 2 lyrical is sourced, but"),
]


@pytest.mark.parametrize(("commands", "variables", "complaint"), COMPLAINTS)
def test_one_line_says_what_is_missing(system, commands, variables, complaint):
    for name, script in commands.items():
        system.add(name, script)
    system.env |= variables
    result = system.check()
    assert (result.returncode, result.stdout) == (1, "")
    (line,) = result.stderr.splitlines()
    assert complaint in line


def test_the_lower_bounds_are_older_than_the_newest_python(system):
    system.add("python3", "echo 3.13")
    system.add(
        "python3.12", f'case "$2" in *version_info*) echo 3.12 ;; *) exec {PYTHON} "$@" ;; esac'
    )
    system.env["BOUNDS"] = "lowest"
    assert system.check().stdout.strip() == PYTHON
    (system.folder / "python3.12").unlink()
    assert "no Python 3.11 or 3.12 found" in system.check().stderr


@pytest.mark.parametrize("release", ["jazzy", "kilted", "lyrical"])
def test_these_releases_of_ros_may_be_sourced(system, release):
    system.add("python3", without("rclpy").replace("*rclpy*) exit 1", "*rclpy*) exit 0"))
    system.env["ROS_DISTRO"] = release
    assert system.check().returncode == 0


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
