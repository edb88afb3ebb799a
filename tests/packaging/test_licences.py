"""scripts/licences.py: what is installed is in docs/licences.md, under the licence that it has."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from .conftest import ROOT


def check(prefix: str | Path) -> tuple[int, str]:
    done = subprocess.run(
        [sys.executable, ROOT / "scripts" / "licences.py", "--check", prefix],
        capture_output=True,
        text=True,
    )
    assert "Traceback" not in done.stderr
    return done.returncode, done.stderr


@pytest.fixture
def environment(tmp_path: Path) -> Path:
    """An environment with turtlesim_py in it, which requires `given`."""
    installed(tmp_path, "turtlesim_py", "Requires-Dist: given>=1")
    return tmp_path


def installed(prefix: Path, name: str, line: str) -> None:
    folder = prefix / "lib" / "python3.11" / "site-packages" / f"{name}-1.0.dist-info"
    folder.mkdir(parents=True)
    (folder / "METADATA").write_text(f"Metadata-Version: 2.4\nName: {name}\nVersion: 1.0\n{line}\n")


@pytest.mark.skipif("ROS_DISTRO" in os.environ, reason="apt's packages are apt's to list")
def test_all_that_is_installed_here_is_in_the_list() -> None:
    assert check(sys.prefix) == (0, "")


def test_what_is_not_in_the_list_fails(environment: Path) -> None:
    installed(environment, "given", "License-Expression: MIT")
    code, said = check(environment)
    assert code == 1
    assert "given: MIT, and docs/licences.md has nothing of it" in said


@pytest.mark.parametrize(
    ("line", "found"),
    [("License-Expression: GPL-3.0-only", "GPL-3.0-only"), ("Summary: x", "none")],
)
def test_a_licence_that_nobody_has_accepted_fails(environment: Path, line: str, found: str) -> None:
    installed(environment, "given", line)
    code, said = check(environment)
    assert code == 1
    assert f"given 1.0: its licence is {found}; nobody has accepted that" in said


def test_a_changed_licence_fails(tmp_path: Path) -> None:
    installed(tmp_path, "turtlesim_py", "Requires-Dist: numpy; python_version > '3'")
    installed(tmp_path, "numpy", "Classifier: License :: OSI Approved :: MIT License")
    code, said = check(tmp_path)
    assert code == 1
    assert "numpy: MIT, and docs/licences.md has 0BSD AND" in said


def test_a_library_in_a_wheel_of_ros_that_nobody_has_looked_at_fails(environment: Path) -> None:
    installed(environment, "given", "License-Expression: MIT")
    libraries = environment / "lib" / "python3.11" / "site-packages" / "ros_rcl.libs"
    libraries.mkdir()
    (libraries / "libstrange-0123abcd.so.1").touch()
    code, said = check(environment)
    assert code == 1
    assert "libstrange" in said
    (environment / "lib" / "libstrange.so.1").touch()  # it is ROS's own, once more
    assert "libstrange" not in check(environment)[1]


@pytest.mark.skipif("ROS_DISTRO" in os.environ, reason="there is nothing of ours beside ROS's")
def test_the_texts_come_with_what_is_under_them() -> None:
    (shared,) = Path(sys.prefix, "share").glob("turtlesim-py-*")
    texts = {path.name: path.read_text().split() for path in shared.iterdir()}
    assert {name: text[:2] for name, text in texts.items()} == {
        "LICENSE": (ROOT / "LICENSE").read_text().split()[:2],
        "LICENSE-Apache-2.0": ["Apache", "License"],
    }
