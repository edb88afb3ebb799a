"""The build of the interface packages: one source, and nothing of another ROS is taken over."""

import os
import re
import sys
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
from setuptools import Distribution
from setuptools.command.build_ext import build_ext
from setuptools.errors import CompileError

from grader.ros import building
from interfaces import build

#: The build forks; a worker of pytest-xdist has a thread.
pytestmark = pytest.mark.filterwarnings("ignore:.*multi-threaded:DeprecationWarning")


@pytest.fixture
def built(monkeypatch, tmp_path):
    """Says which packages were compiled, by a compiler that only touches files."""
    log = tmp_path / "compiled"

    def compile_nothing(command: build_ext, extension: build.Extension) -> None:
        with log.open("a") as said:  # of another process
            said.write(extension.name.partition(".")[0] + "\n")
        module = Path(command.get_ext_fullpath(extension.name))
        module.parent.mkdir(parents=True, exist_ok=True)
        module.touch()

    monkeypatch.setattr(building, "generate", lambda *words: words[-1].mkdir(parents=True))
    monkeypatch.setattr(build, "_ros_version", lambda: "0.22.2")
    monkeypatch.setattr(building, "configure", lambda *_: None)
    monkeypatch.setattr(build_ext, "build_extension", compile_nothing)
    monkeypatch.chdir(tmp_path)
    return lambda: sorted(log.read_text().split())


def make() -> None:
    command = build.BuildInterfaces(Distribution({"ext_modules": build.extensions()}))
    command.ensure_finalized()
    command.run()


def test_what_is_built_is_not_built_again(built):
    make()
    make()
    assert built() == sorted(build.PACKAGES)


def test_what_was_built_with_another_ros_is_built_again(built, monkeypatch):
    make()
    monkeypatch.setattr(build, "_ros_version", lambda: "0.24.2")
    make()
    assert built() == sorted([*build.PACKAGES] * 2)


def test_one_package_that_cannot_be_built_fails_the_build(built, monkeypatch):
    def compile_but_one(command: build_ext, extension: build.Extension) -> None:
        if extension.name.startswith("tf2_msgs"):
            sys.exit("a compiler's complaint")

    monkeypatch.setattr(build_ext, "build_extension", compile_but_one)
    with pytest.raises(CompileError, match="tf2_msgs"):
        make()


@pytest.mark.applies("ROS_DISTRO" not in os.environ, reason="nothing is built there")
def test_packages_that_are_built_side_by_side_share_no_source_and_so_no_object_file(tmp_path):
    sources = []
    for extension, package in zip(build.extensions(), build.PACKAGES, strict=True):
        (tmp_path / package).mkdir()
        building.configure(extension, tmp_path / package, build.DEPENDENCIES, "", package)
        sources += extension.sources
    assert len(sources) == len(set(sources)) >= 3 * len(build.PACKAGES)


@pytest.mark.applies("ROS_DISTRO" not in os.environ, reason="nothing is built there")
def test_what_is_linked_comes_with_what_a_build_asks_for():
    """A build for a wheel has nothing else; that of `make install` has all."""
    for path in build.HERE.glob("*/pyproject.toml"):
        release = tomllib.loads(path.read_text(encoding="utf-8"))
        found: set[str] = set()
        wanted = [re.split(r"[\[=]", line)[0] for line in release["tool"]["turtlesim-py"]["build"]]
        while wanted:
            name = wanted.pop()
            if name not in found:
                found.add(name)
                lines = metadata.requires(name) or []
                wanted += [re.match(r"[\w.-]+", line)[0] for line in lines if "extra" not in line]
        assert {f"ros-{name.replace('_', '-')}" for name in build.DEPENDENCIES} <= found
