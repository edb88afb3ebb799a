"""Beside a sourced ROS: what package.xml asks for is enough for every verb."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from itertools import filterfalse
from pathlib import Path

import pytest

from grader.reports import names
from grader.requirements import OPTIONAL
from tests.programs import ran

from .conftest import ROOT
from .rosdep import KEYS, dependencies, depends, hide_all_but, imported, keys

pytestmark = pytest.mark.applies(
    "ROS_DISTRO" not in os.environ, reason="there the packages are apt's, which this imitates"
)
ONE_RUN = "exercise: turtlesim_challenge\nvaried_runs: {count: 0}\n"
CLASSROOM_50 = {
    **dict.fromkeys(("CLASSROOM", "ASSIGNMENT", "COMMIT_URL", "RELEASE_URL", "OWNER"), "x"),
    "SUBMISSION_TAG": "submit/x",
}


#: `grader` with each list of words in turn; prints what each of them says. What is hidden is so for
#: all of them: one does not bring it to the next.
CALLS = """
import io, json, sys
from contextlib import redirect_stdout
from grader.cli import main

said = []
for words in json.loads(sys.argv[1]):
    with redirect_stdout(io.TextIOWrapper(io.BytesIO(), "utf-8")) as out:
        try:
            code = main(words)
        except SystemExit as end:  # of --help
            code = end.code
    assert not code, words
    out.flush()
    said.append(out.buffer.getvalue().decode())
print(json.dumps(said))
"""


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

    def grader(self, *arguments: str | Path, code: int = 0) -> subprocess.CompletedProcess[str]:
        call = ran(
            [sys.executable, "-P", "-m", "grader", *arguments], cwd=self.folder, env=self.env
        )
        assert call.returncode == code, call.stdout + call.stderr
        return call

    def graders(self, *calls: tuple[str, ...]) -> list[str]:
        """What several calls say, in one process: its start is most of what they take."""
        words = [sys.executable, "-P", "-c", CALLS, json.dumps(calls)]
        call = ran(words, cwd=self.folder, env=self.env)
        assert call.returncode == 0, call.stdout + call.stderr
        return list(json.loads(call.stdout))


@pytest.fixture(scope="module")
def shell(tmp_path_factory):
    """What rosdep gets from apt."""
    folder = tmp_path_factory.mktemp("rosdep")
    names = [name for name, key in KEYS.items() if not key.startswith("lib")]
    return Shell(hide_all_but(folder / "hiding", names), folder)


@pytest.fixture(scope="module")
def graded(shell):
    """The folder of a graded run of the reference controller."""
    controller = ROOT / "turtlesim_challenge" / "turtle_controller.py"
    (shell.folder / "one_run.yaml").write_text(ONE_RUN)
    shell.grader("run", controller, "--exercise", "one_run.yaml", "--out", "graded")
    return shell.folder / "graded"


def test_package_xml_asks_for_what_pip_is_asked_for():
    core = {KEYS[name] for name in dependencies()}
    assert keys("grader/package.xml") == core
    assert keys("package.xml") == core | {"xacro"}
    assert "xacro" in keys("grader_robots/package.xml")


MANIFESTS = {
    "package.xml": ["turtlesim_py", "turtlesim_challenge", "grader", "grader_robots", "robot_py"],
    **{f"{name}/package.xml": [name] for name in ("grader", "grader_robots", "robot_py")},
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


@pytest.mark.more("starts the grader; what is imported is read from the sources")
def test_what_is_not_in_package_xml_is_hidden_from_these_tests(shell):
    code = (
        "import numpy, rclpy\n"
        "for name in ('pytest', 'rosbags', 'backports.zstd'):\n"
        "    try: __import__(name)\n    except ImportError: print('hidden')"
    )
    call = ran([sys.executable, "-P", "-c", code], env=shell.env)
    assert call.stdout == "hidden\n" * 3, call.stderr


@pytest.mark.more("starts the grader; what is imported is read from the sources")
def test_every_verb_has_help(shell):
    verbs = ("run", "check", "report", "new")
    common, *own = shell.graders(("--help",), *((verb, "--help") for verb in verbs))
    assert [verb for verb, said in zip(verbs, own, strict=True) if verb in said] == [*verbs]
    assert all(verb in common for verb in verbs)


@pytest.mark.more("starts the grader; what is imported is read from the sources")
def test_new_makes_a_solution(shell):
    shell.grader("new", "my_solution")
    assert (shell.folder / "my_solution" / "package.xml").exists()


@pytest.mark.more("starts the grader; what is imported is read from the sources")
def test_run_and_check_judge_the_reference_alike(shell, graded):
    shell.grader("check", graded, "--json", "again.json", "--exercise", "one_run.yaml")
    results = [graded / "result.json", shell.folder / "again.json"]
    assert [json.loads(path.read_text())["score"] for path in results] == [100, 100]


@pytest.mark.more("starts the grader; what is imported is read from the sources")
def test_every_other_format_is_written(shell, graded):
    forms = sorted(set(names()) - {"html"})
    result = str(graded / "result.json")
    said = shell.graders(*(("report", result, "--format", form) for form in forms))
    assert [form for form, text in zip(forms, said, strict=True) if text] == forms


@pytest.mark.more("starts the grader; what is imported is read from the sources")
def test_the_page_is_written(shell, graded):
    assert "<svg" in shell.grader("report", graded / "result.json", "--format", "html").stdout
