"""Beside a sourced ROS: what package.xml asks for is enough for every verb."""

from __future__ import annotations

import json
import os
import re
import sys
from itertools import filterfalse
from pathlib import Path

import pytest

from grader.reports.formats import names
from grader.system.requirements import OPTIONAL
from tests.programs import ran

from .conftest import ROOT
from .rosdep import KEYS, dependencies, depends, hide_all_but, imported, keys

pytestmark = pytest.mark.applies(
    "ROS_DISTRO" not in os.environ, reason="there the packages are apt's, which this imitates"
)
STARTS = pytest.mark.more("starts the grader; what is imported is read from the sources")
ONE_RUN = "exercise: turtlesim_challenge\nvaried_runs: {count: 0}\n"
CLASSROOM_50 = {
    **dict.fromkeys(("CLASSROOM", "ASSIGNMENT", "COMMIT_URL", "RELEASE_URL", "OWNER"), "x"),
    "SUBMISSION_TAG": "submit/x",
}


class Shell:
    """Runs the grader where rosdep has installed what package.xml asks for, and nothing else is.

    Args:
        hiding: what `hide_all_but` has made.
        folder: the current folder.
    """

    def __init__(self, hiding: Path, folder: Path) -> None:
        self.folder = folder
        path = os.pathsep.join([str(hiding), str(ROOT)])
        # ROS_DISTRO: as beside a sourced ROS, PYTHONPATH reaches all processes of a run
        self.env = os.environ | CLASSROOM_50 | {"PYTHONPATH": path, "ROS_DISTRO": "jazzy"}

    def python(self, *words: object) -> str:
        """What a Python prints, which must not fail."""
        call = ran([sys.executable, "-P", *words], cwd=self.folder, env=self.env)
        assert call.returncode == 0, call.stdout + call.stderr
        return call.stdout


@pytest.fixture(scope="module")
def shell(tmp_path_factory):
    """What rosdep gets from apt."""
    folder = tmp_path_factory.mktemp("rosdep")
    names = [name for name, key in KEYS.items() if not key.startswith("lib")]
    return Shell(hide_all_but(folder / "hiding", names), folder)


def test_package_xml_asks_for_what_pip_is_asked_for():
    core = {KEYS[name] for name in dependencies()}
    assert keys("grader/package.xml") == core
    assert keys("package.xml") == core | {"xacro"}
    assert "xacro" in keys("grader_robots/package.xml")


MANIFESTS = {
    "package.xml": ["turtlesim_py", "turtlesim_challenge", "grader", "grader_robots"],
    **{f"{name}/package.xml": [name] for name in ("grader", "grader_robots")},
    "turtlesim_challenge/package.xml": ["turtlesim_challenge"],
}
#: What comes with the generators of interfaces.
GENERATORS = re.compile(r"rosidl_(generator|typesupport)_\w+")


@pytest.mark.parametrize("manifest", MANIFESTS)
def test_package_xml_asks_for_what_is_imported_of_ros(manifest):
    wanted = set().union(*map(imported, MANIFESTS[manifest]))
    if any(map(GENERATORS.fullmatch, wanted)):
        wanted = {"rosidl_default_generators", *filterfalse(GENERATORS.fullmatch, wanted)}
    asked = depends(manifest, "jazzy")
    assert wanted <= asked
    assert not [key for key in asked if key.endswith("-pip")]  # bloom would take it for apt's


@pytest.mark.parametrize("manifest", ["package.xml", "turtlesim_challenge/package.xml"])
@pytest.mark.parametrize(
    ("release", "interfaces"),
    [
        *((release, "turtlesim") for release in ("", "humble", "jazzy")),
        *((release, "turtlesim_msgs") for release in ("kilted", "lyrical", "rolling")),
    ],
)
def test_package_xml_asks_for_the_interfaces_that_a_release_has(manifest, release, interfaces):
    assert depends(manifest, release) & {"turtlesim", "turtlesim_msgs"} == {interfaces}


def test_a_package_that_is_missing_is_named_with_the_bounds_of_pyproject():
    known = {**dependencies(), **dependencies("cluster")}
    assert {name: wanted for name, (_, _, wanted) in OPTIONAL.items()} == {
        name: known[name.replace(".", "-")].partition(";")[0] for name in OPTIONAL
    }
    for name, wanted in dependencies("cluster").items():
        assert dependencies("test")[name] == wanted


@STARTS
def test_what_is_not_in_package_xml_is_hidden_from_these_tests(shell):
    code = (
        "import numpy, rclpy\n"
        "for name in ('pytest', 'rosbags', 'backports.zstd'):\n"
        "    try: __import__(name)\n    except ImportError: print('hidden')"
    )
    assert shell.python("-c", code) == "hidden\n" * 3


@STARTS
def test_new_makes_a_solution(shell):
    shell.python("-m", "grader", "new", "my_solution")
    assert (shell.folder / "my_solution" / "package.xml").exists()


@STARTS
def test_run_check_and_report_do_their_work(shell):
    controller = ROOT / "turtlesim_challenge" / "turtle_controller.py"
    (shell.folder / "one_run.yaml").write_text(ONE_RUN)
    one_run = ("--exercise", "one_run.yaml")
    shell.python("-m", "grader", "run", controller, *one_run, "--out", "graded")
    shell.python("-m", "grader", "check", "graded", "--json", "again.json", *one_run)
    results = [shell.folder / "graded/result.json", shell.folder / "again.json"]
    assert [json.loads(path.read_text())["score"] for path in results] == [100, 100]
    for form in names():
        report = shell.python("-m", "grader", "report", results[0], "--format", form)
        assert ("<svg" if form == "html" else "") in report
        assert report
