"""Tokens of CI systems never reach a submission's process: not by the grader, not by grade.sh."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.attacks.attacks import MOVES
from tests.grader.course.machine import Machine, scripts

ROOT = Path(__file__).parents[2]
#: What holds a secret, or leads to one, on some system: by its documentation.
VARIABLES = (
    *("GITHUB_TOKEN", "GH_TOKEN", "ACTIONS_RUNTIME_TOKEN", "ACTIONS_ID_TOKEN_REQUEST_TOKEN"),
    *("GITHUB_ENV", "GITHUB_OUTPUT", "GITHUB_STEP_SUMMARY", "GITHUB_PATH"),
    *("CI_JOB_TOKEN", "CI_REGISTRY_PASSWORD", "CI_DEPLOY_PASSWORD", "CI_JOB_JWT_V2"),
    *("AWS_SECRET_ACCESS_KEY", "AWS_SESSION_TOKEN", "AWS_CONTAINER_CREDENTIALS_RELATIVE_URI"),
    *("AZURE_CLIENT_SECRET", "GOOGLE_APPLICATION_CREDENTIALS", "KUBECONFIG", "DOCKER_AUTH_CONFIG"),
    *("SSH_AUTH_SOCK", "SSH_PRIVATE_KEY", "NETRC", "PIP_INDEX_URL", "TWINE_PASSWORD", "NPM_TOKEN"),
    *("SUBMISSION_ID", "GRADESCOPE_TOKEN", "CANVAS_TOKEN", "A_VARIABLE_THAT_NOBODY_KNOWS"),
    *("ROS_TOKEN", "PYTHON_TOKEN", "LC_TOKEN", "AMENT_TOKEN", "LANG_TOKEN", "GRADER_TOKEN"),
)
SUBMISSION = """
import os
print(os.environ)
for path in ("/proc/self/environ", "/proc/%d/environ" % os.getppid()):
    try:
        print(open(path, "rb").read())
    except OSError:
        pass
print("looked")
"""
CANARY = "CANARY-0f3a"


@pytest.fixture
def machine(tmp_path: Path) -> Iterator[Machine]:
    yield Machine(tmp_path, real=True)


@pytest.mark.parametrize("way", ["grader run", "grade.sh"])
def test_a_submission_graded_in_ci_sees_no_token(machine: Machine, way: str) -> None:
    student, exercise = machine.folder / "student.py", machine.folder / "exercise.yaml"
    student.write_text(SUBMISSION)
    exercise.write_text("exercise: turtlesim_challenge\n" + MOVES)
    tokens = dict.fromkeys(VARIABLES, CANARY)
    graded = machine.work / "graded"
    if way == "grade.sh":
        done = machine.bash(
            scripts() / "grade.sh", student, machine.work, EXERCISE=str(exercise), **tokens
        )
    else:
        words = ["run", student, "--exercise", exercise, "--out", graded]
        done = subprocess.run(
            [sys.executable, "-m", "grader", *map(str, words)],
            cwd=ROOT,
            env=os.environ | tokens,
            capture_output=True,
            text=True,
            check=False,
        )
    assert done.returncode == 0, done.stdout + done.stderr
    printed = (graded / "output.txt").read_text()
    assert "looked" in printed
    assert CANARY not in printed
    left = [
        path
        for path in graded.rglob("*")
        if path.is_file() and CANARY.encode() in path.read_bytes()
    ]
    assert left == []
