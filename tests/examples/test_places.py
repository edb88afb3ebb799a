"""examples/devcontainer, docker and pixi: what can be checked of them without docker and conda."""

from __future__ import annotations

import json
import re
import subprocess
import tomllib
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
SOURCE = "git+https://example.org/turtlesim-py.git@v0.1.0"
INSTRUCTIONS = {"FROM", "ARG", "RUN", "ENV", "COPY", "WORKDIR", "USER", "ENTRYPOINT", "CMD"}


@pytest.fixture(scope="module")
def devcontainer() -> dict[str, Any]:
    text = (EXAMPLES / "devcontainer" / "devcontainer.json").read_text(encoding="utf-8")
    found: dict[str, Any] = json.loads(re.sub(r"(?m)^\s*//.*$", "", text))
    return found


@pytest.fixture(scope="module")
def docker() -> list[tuple[str, str]]:
    """The instructions of the Dockerfile: name, words."""
    text = (EXAMPLES / "docker" / "Dockerfile").read_text(encoding="utf-8")
    lines = re.sub(r"(?m)^#.*\n", "", text).replace("\\\n", " ").splitlines()
    return [(name, words) for name, _, words in (line.partition(" ") for line in lines) if name]


@pytest.fixture(scope="module")
def pixi() -> dict[str, Any]:
    return tomllib.loads((EXAMPLES / "pixi" / "pixi.toml").read_text(encoding="utf-8"))


def test_the_dockerfile_stands_on_ros_jazzy(docker) -> None:
    assert docker[0] == ("FROM", "ros:jazzy")
    assert {name for name, _ in docker} <= INSTRUCTIONS


def test_what_the_dockerfile_runs_is_shell(docker) -> None:
    for name, words in docker:
        if name == "RUN":
            subprocess.run(["sh", "-n", "-c", words], check=True)


def test_the_dockerfile_takes_nothing_of_ros_from_pip(docker) -> None:
    (install,) = [words for name, words in docker if name == "RUN" and " pip install" in words]
    assert ". /opt/ros/jazzy/setup.sh &&" in re.sub(" +", " ", install)  # sets ROS_DISTRO
    assert "--system-site-packages" in install


def test_the_devcontainer_builds_the_dockerfile(devcontainer, docker) -> None:
    assert devcontainer["build"]["dockerfile"] == "Dockerfile"
    arguments = {words for name, words in docker if name == "ARG"}
    assert devcontainer["build"]["args"] == {"GRADER_SOURCE": SOURCE}
    assert set(devcontainer["build"]["args"]) == arguments
    interpreter = devcontainer["customizations"]["vscode"]["settings"][
        "python.defaultInterpreterPath"
    ]
    assert any(
        f"venv --system-site-packages {interpreter.removesuffix('/bin/python')}" in words
        for _, words in docker
    )


def test_the_devcontainer_forwards_what_it_serves(devcontainer) -> None:
    (port,) = devcontainer["forwardPorts"]
    assert list(devcontainer["portsAttributes"]) == [str(port)]
    command = devcontainer["postStartCommand"]
    subprocess.run(["sh", "-n", "-c", command], check=True)
    assert f"http.server {port} " in command
    assert "--directory graded" in command  # where `grader run` leaves its reports


def test_pixi_requires_what_we_require(pixi) -> None:
    ours = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    required = {}
    # what builds is installed there, too, and asks for more of the same
    for text in (*ours["project"]["dependencies"], *ours["build-system"]["requires"]):
        match = re.match(r"([\w.-]+)([^;]*)", text)
        assert match
        required[match[1]] = match[2]
    given = {**pixi["dependencies"], **pixi["pypi-dependencies"]}
    assert {name: given.get(name) for name in required} == required
    (setuptools,) = ours["build-system"]["requires"]
    assert f"setuptools{given['setuptools']}" == setuptools


def test_pixi_s_ros_is_jazzy_and_not_pip_s(pixi) -> None:
    ros = [name for name in pixi["dependencies"] if "ros" in name]
    assert ros
    assert all(name.startswith("ros-jazzy-") for name in ros)
    assert list(pixi["pypi-dependencies"]) == ["backports.zstd"]
    assert pixi["activation"]["env"] == {"ROS_DISTRO": "jazzy", "GRADER_SOURCE": SOURCE}
    assert "--no-deps" in pixi["tasks"]["install"]
    assert {"osx-arm64", "win-64", "linux-aarch64"} <= set(pixi["workspace"]["platforms"])


@pytest.mark.parametrize("file", ["devcontainer/devcontainer.json", "pixi/pixi.toml"])
def test_what_is_to_edit_is_marked(file: str) -> None:
    lines = (EXAMPLES / file).read_text(encoding="utf-8").splitlines()
    places = [number for number, line in enumerate(lines) if SOURCE in line]
    assert all("EDIT:" in lines[number - 1] for number in places)
    assert len(places) == 1
