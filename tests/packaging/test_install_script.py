"""scripts/install.sh: what it asks pip or uv for, when, and what it says where they fail."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.programs import ran

from .conftest import ROOT, System

PYTHON = str(Path(sys.executable).resolve())
JAZZY = "pip ./interfaces/jazzy"
ALL = "pip . ./interfaces/jazzy"
#: Asks what is missing.
COMPILER = "grader/ros/compiler.py"
#: Answers as the Python of .venv does, and notes what it was asked.
VENV_PYTHON = f"""\
[ "$*" = "-c " ] || echo "$*" >>calls
case "$*" in
*requirements.py*) exec {PYTHON} "$@" ;;
*pip*install*) printf %s "${{COMPILE-unset}}" >compiles; [ ! -e says ] || {{ cat says; exit 1; }} ;;
*compiler.py*) [ ! -e lacking ] || {{ cat lacking; exit 1; }} ;;
esac"""
UV = """\
[ "$1" = --version ] || echo "uv $*" >>calls
case "$*" in *install*) [ ! -e says ] || { cat says; exit 1; } ;; esac"""


class Install:
    """A checkout whose .venv has been made, with a pip that installs nothing."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        shutil.copytree(ROOT / "scripts", folder / "scripts")
        shutil.copy(ROOT / "Makefile", folder)
        python = System(folder / ".venv" / "bin")
        python.folder.mkdir(parents=True)
        python.add("python", VENV_PYTHON)
        self.commands = System(folder.parent / "commands")
        self.commands.folder.mkdir()
        self.env = {"PATH": f"{self.commands.folder}:{os.environ['PATH']}"}
        self.made_for("no ROS")

    def made_for(self, ros: str) -> None:
        (self.folder / ".venv" / "made-in").write_text(f"{self.folder} {ros}\n")

    def run(self, target: str = "install") -> subprocess.CompletedProcess[str]:
        return ran(["make", "-C", self.folder, target], env=self.env)

    def calls(self, target: str = "install") -> list[str]:
        """What is asked of pip, uv and Python, but for the requirements' names."""
        (self.folder / "calls").write_text("")
        result = self.run(target)
        assert result.returncode == 0, result.stderr
        lines = (self.folder / "calls").read_text().splitlines()
        return [line for line in lines if "requirements.py" not in line]

    def compiles(self) -> str:
        """COMPILE, as the last build found it."""
        return (self.folder / "compiles").read_text()

    def complaint(self, said: str) -> list[str]:
        """What is said where pip or uv fails with `said`."""
        (self.folder / "says").write_text(said)
        result = self.run()
        assert result.returncode != 0
        return [line for line in result.stderr.splitlines() if not line.startswith("make")]


@pytest.fixture
def install(checkout):
    """Without uv, wherever the tests run."""
    install = Install(checkout)
    install.commands.add("uv", "exit 127")
    return install


def packages(calls: list[str]) -> list[str]:
    """Whose packages: `pip` or `uv`, and the folders of the project's own."""
    return [
        f"{'uv' if call.startswith('uv') else 'pip'} {' '.join(own) or 'needs'}"
        for call in calls
        if " install " in call
        for own in [[word for word in call.split() if word == "." or word.startswith("./")]]
    ]


def test_the_project_goes_in_after_what_it_needs_and_then_byte_code_is_made(install):
    calls = install.calls()
    assert packages(calls) == ["pip needs", ALL]
    assert all("--no-compile" in call for call in calls if " install " in call)
    assert calls[-1].startswith("-m compileall")


def test_what_is_compiled_is_installed_anew_only_where_it_has_changed(install):
    install.calls()
    (install.folder / "tf2" / "tf2_ros" / "buffer.py").touch()
    assert install.calls() == []
    (install.folder / "tf2" / "tf2_ros" / "buffer.py").write_text("")
    assert packages(install.calls()) == [JAZZY]


@pytest.mark.parametrize("target", ["install", "tools"])
def test_with_nothing_to_do_nothing_is_done(install, target):
    install.calls(target)
    assert install.calls(target) == []


@pytest.mark.parametrize("change", ["changed", "added", "deleted", "renamed"])
def test_a_file_that_is_not_as_it_was_is_noticed(install, change):
    install.calls()
    path = install.folder / "grader" / "errors.py"
    if change == "changed":
        stat = path.stat()
        path.write_bytes(path.read_bytes().swapcase())
        os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))
    elif change == "added":
        path.with_name("zzz.py").touch()
    elif change == "deleted":
        path.unlink()
    else:
        path.rename(path.with_name("zzz.py"))
    assert packages(install.calls()) == ["pip ."]


def test_what_failed_is_tried_again(install):
    install.complaint("ERROR: no space left")
    (install.folder / "says").unlink()
    assert packages(install.calls()) == ["pip needs", ALL]


def test_only_tests_and_linters_get_what_they_need_besides(install):
    install.calls()
    assert packages(install.calls("tools")) == ["pip needs"]
    assert install.calls("install") == []


def test_what_the_tests_need_holds_all_that_the_project_needs():
    """So pip changes nothing of it for their sake."""
    few, all_ = (
        ran(
            [sys.executable, ROOT / "scripts" / "requirements.py", *level], check=True
        ).stdout.splitlines()
        for level in ([], ["test"])
    )
    assert set(few) < set(all_)
    assert not [line for line in few if line.startswith(("pytest", "mypy", "ruff", "playwright"))]


@pytest.mark.parametrize(
    ("env", "own"),
    [
        ({}, ["uv needs", ALL.replace("pip", "uv")]),
        ({"UV": ""}, ["pip needs", ALL]),
        ({"ROS_DISTRO": "jazzy"}, ["pip needs", "pip ."]),
        ({"UV": "", "ROS": "kilted"}, ["pip needs", "pip . ./interfaces/kilted"]),
    ],
)
def test_uv_is_used_where_it_is_and_wanted_and_no_ros_is_sourced(install, env, own):
    install.commands.add("uv", UV)
    install.env |= env
    if "ROS_DISTRO" in env:
        install.made_for("jazzy")
    if "ROS" in env:
        (install.folder / ".venv").rename(install.folder / ".venv-kilted")
    assert packages(install.calls()) == own


def test_without_a_compiler_definitions_are_installed_and_the_last_lines_say_so(install):
    (install.folder / "lacking").write_text("missing: cc (sudo apt install cc)\n")
    lines = [line for line in install.run().stdout.splitlines() if line.startswith("== ")]
    assert install.compiles() == ""
    assert "turtlesim_node, other nodes and grader run --time real need" in lines[-2]
    assert lines[-1] == "== missing: cc (sudo apt install cc), then: make install"
    assert install.calls() == [COMPILER]
    (install.folder / "lacking").unlink()
    assert packages(install.calls()) == [JAZZY]
    assert install.compiles() == "yes"
    assert install.calls() == []


def test_without_need_nothing_is_compiled_and_nothing_that_was_is_lost(install):
    asked = dict(install.env)
    install.env |= {"COMPILE": ""}
    assert COMPILER not in install.calls()
    assert install.compiles() == ""
    assert "grader run" not in install.run().stdout
    install.env = asked
    assert packages(install.calls()) == [JAZZY]
    install.env |= {"COMPILE": ""}
    assert install.calls() == []
    (install.folder / "tf2" / "tf2_ros" / "buffer.py").write_text("")
    assert packages(install.calls()) == [JAZZY]
    assert install.compiles() == "yes"


def test_what_a_build_refuses_is_said_in_one_line(install):
    said = "╰─> [1 lines of output]\n      Cannot install: ROS 2\nerror: subprocess-exited"
    assert install.complaint(said) == ["Cannot install: ROS 2"]


@pytest.mark.parametrize(
    "said",
    [
        "WARNING: Retrying ... NewConnectionError('<pip._vendor...>: Failed to establish')",
        "ERROR: Could not install packages due to an OSError: ProxyError('Cannot connect')",
    ],
)
def test_a_network_that_fails_is_said_in_one_line(install, said):
    (line,) = install.complaint(said)
    assert line.startswith("Cannot install: pip does not reach the package index")


def test_where_uv_has_no_network_pip_may_know_a_way(install):
    install.commands.add("uv", UV)
    first, second = install.complaint(
        "error: Request failed after 3 retries in 5.5s\n"
        "  cause: error sending request for url (https://pypi.org/simple/xacro/)"
    )
    assert first.startswith("Cannot install: uv does not reach the package index")
    assert "`make UV= ...`" in second
