"""What each system runs of a course, with everything around it imitated.

A stub stands for `grader run`; the last ones grade for real.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml

from grader.exercise.places import installed
from grader.submission.manifest import naming
from tests.grader_class.course.machine import EXERCISES, FOR_THE_REAL_ONE, Machine, an_error
from tests.programs import ROOT
from tests.tiers import others_are_more

SPIRAL = ROOT / "tests" / "submissions" / "quick_spiral.py"

# Each function runs what the system would run, and returns what became of it: 0 points or more,
# None where there is no judgement; and what the student can read.

UNUSABLE = an_error("submission", 'hand in <one> "file".')


@dataclass(frozen=True)
class HandIn:
    """What a student hands in, for which exercise, and how the staff has edited that."""

    student: Path
    exercise: str = EXERCISES[0]
    rubric: str = ""
    pass_points: str = ""


def on_github(machine, given):
    """Its two jobs, step by step, as `bash -e` in the checkout: the hand-in, and what grades it."""
    template = machine.lay("github", given.rubric) / "templates" / given.exercise
    checkout = machine.folder / "checkout"
    shutil.copytree(given.student, checkout)
    shutil.copytree(template / ".github", checkout / ".github")
    workflow = yaml.safe_load((checkout / ".github" / "workflows" / "grade.yml").read_text())
    temp, output, summary = (machine.folder / name for name in ("temp", "output", "summary"))
    temp.mkdir()
    env = {key: str(value) for key, value in workflow["env"].items()}
    env |= {"PASS_POINTS": given.pass_points} if given.pass_points else {}
    env |= {"GRADER_VENV": str(machine.venv), "RUNNER_TEMP": str(temp)}
    env |= {"GITHUB_OUTPUT": str(output), "GITHUB_STEP_SUMMARY": str(summary)}
    codes = [
        machine.bash("-e", "-c", step["run"], cwd=checkout, **env).returncode
        for step in workflow["jobs"]["grade"]["steps"]
        if "run" in step
    ]
    code = dict(line.split("=") for line in output.read_text().splitlines())["code"]
    assert any(codes) == (code not in ("0", "1", "2")), "red is the staff's turn"

    # what the artifact carries into a job without a checkout
    fresh = machine.folder / "fresh"
    shutil.copytree(temp / "graded", fresh / "graded")
    env |= {"CODE": code, "GITHUB_REPOSITORY": "course/student", "GITHUB_SHA": "0" * 40}
    (step,) = (step for step in workflow["jobs"]["report"]["steps"] if "run" in step)
    report = machine.bash("-e", "-c", step["run"], cwd=fresh, **env)
    assert report.returncode == 0, report.stderr
    asked = (machine.folder / "gh.txt").read_text()
    title = re.search(r"output\[title\]=(.*)", asked)
    conclusion = re.search(r"conclusion=(.*)", asked)
    if code in ("0", "1"):
        junit_score(temp / "graded" / "junit.xml")
        assert "<html" in (temp / "graded" / "report.html").read_text()
    wanted = {"0": "success", "1": "failure", "2": "failure"}.get(code, "action_required")
    assert conclusion[1] == wanted
    points = re.match(r"([\d.]+)(?: of [\d.]+)? points", title[1])
    return float(points[1]) if points else None, asked + summary.read_text()


def on_gitlab(machine, given):
    """Its only job, in the project's folder."""
    template = machine.lay("gitlab", given.rubric) / "templates" / given.exercise
    project = machine.folder / "project"
    shutil.copytree(given.student, project)
    shutil.copytree(template / ".gitlab", project / ".gitlab")
    workflow = yaml.safe_load((template / ".gitlab-ci.yml").read_text())
    env = {key: str(value) for key, value in workflow["variables"].items()}
    env |= {"PASS_POINTS": given.pass_points} if given.pass_points else {}
    env |= {"GRADER_VENV": str(machine.venv)}
    job = workflow["grade"]
    script = "\n".join([*job["before_script"], *job["script"]])
    run = machine.bash("-e", "-c", script, cwd=project, **env)
    if run.returncode < 2:
        junit_score(project / job["artifacts"]["reports"]["junit"])
    if run.returncode == job["retry"]["exit_codes"]:
        return None, run.stderr
    points = re.findall(job["coverage"].strip("/"), run.stdout, re.MULTILINE)
    return float(points[-1]), run.stdout + run.stderr


def on_gradescope(machine, given):
    """A tree like /autograder, with the zip that `make` packs; setup.sh has been run."""
    laid = machine.lay("gradescope", given.rubric)
    assert machine.bash("-c", "make", cwd=laid).returncode == 0
    root = machine.folder / "autograder"
    with zipfile.ZipFile(laid / "build" / f"{given.exercise}-autograder.zip") as packed:
        packed.extractall(root / "source")
    shutil.copytree(given.student, root / "submission")
    setup = machine.bash(root / "source" / "setup.sh", AUTOGRADER_ROOT=str(root))
    assert "already" in setup.stdout, setup.stderr
    run = machine.bash(root / "source" / "run_autograder", AUTOGRADER_ROOT=str(root))
    result = json.loads((root / "results" / "results.json").read_text())
    known = {"score", "execution_time", "output", "output_format", "tests", "extra_data"}
    assert set(result) <= known | {"test_output_format", "test_name_format"}
    assert result["output_format"] in ("text", "html")
    for test in result.get("tests", []):
        assert test["status"] in ("passed", "failed")
    failed = result.get("extra_data") == {"grader_failed": True}
    assert failed == (run.returncode != 0)
    if failed:
        assert result["score"] == 0
    return None if failed else result["score"], result["output"]


def on_classroom50(machine, given):
    """The bundle, and the student's checkout as working folder."""
    laid = machine.lay("classroom50", given.rubric)
    bundle = laid / "autograders" / given.exercise.replace("_", "-")
    student = given.student
    url = "https://host.invalid/"
    names = {
        "CLASSROOM": "ros",
        "ASSIGNMENT": bundle.name,
        "ASSIGNMENT_TYPE": "individual",
        "OWNER": "alice",
        "SUBMISSION_TAG": "submit/2026-06-01T14-32-05Z-a1b2c3d",
        **{name: url + name for name in ("COMMIT_URL", "RELEASE_URL", "REVIEW_URL")},
    }
    run = subprocess.run(
        [sys.executable, bundle / "autograder.py"],
        cwd=student,
        env=machine.env | names,
        capture_output=True,
        text=True,
    )
    if run.returncode != 0:
        assert not (student / "result.json").exists()
        return None, run.stderr
    result = json.loads((student / "result.json").read_text())
    needed = {"schema", "classroom", "assignment", "assignment_type", "owner", "submission"}
    needed |= {"commit", "release", "review", "datetime", "score", "max-score", "tests"}
    assert needed <= set(result) <= needed | {"graded_at", "submitted_by"}
    assert result["schema"] == "classroom50/result/v1"
    assert result["score"] == sum(test["score"] for test in result["tests"])
    assert result["max-score"] == sum(test["max-score"] for test in result["tests"])
    assert all(type(test[key]) is int for test in result["tests"] for key in ("score", "max-score"))
    assert all(type(test["passed"]) is bool and test["test-name"] for test in result["tests"])
    return result["score"], (student / "release-body.md").read_text()


def junit_score(file):
    suite = ElementTree.parse(file).getroot().find("testsuite")
    (score,) = (p.get("value") for p in suite.iter("property") if p.get("name") == "score")
    return float(str(score))


SYSTEMS = [on_github, on_gitlab, on_gradescope, on_classroom50]


def by_systems(*kept, reason):
    """Each of them; in `make test` those that are kept."""
    systems = others_are_more(reason, SYSTEMS, *kept)
    return pytest.mark.parametrize("system", systems, ids=lambda system: system.__name__)


@by_systems(*SYSTEMS, reason="")
@pytest.mark.parametrize("is_passed", others_are_more("less is told", [True, False], False))
def test_the_points_arrive_of_the_exercise_that_the_staff_has_set(machine, system, is_passed):
    """Whatever the hand-in names, and whatever file of a rubric's name lies in it."""
    other, exercise = EXERCISES
    student = machine.submission(f"exit {int(not is_passed)}")
    text = (ROOT / "turtlesim_challenge" / "starter" / "package.xml").read_text()
    (student / "package.xml").write_text(naming(text, other, is_manifest=True))
    (student / "rubric.yaml").write_bytes(installed(other).description.read_bytes())
    points, _ = system(machine, HandIn(student, exercise))
    assert points == (18 if system is on_classroom50 else 17.5)  # which has whole points
    (rubric,) = machine.seen.iterdir()
    assert yaml.safe_load(rubric.read_text())["exercise"] == exercise


@by_systems(on_gitlab, reason="each tells it by the report of errors, which one stands for")
def test_an_unusable_submission_has_no_points_and_says_why(machine, system):
    points, said = system(machine, HandIn(machine.submission(UNUSABLE)))
    assert points == 0
    assert 'hand in <one> "file".' in said.replace("\\", "")


@by_systems(on_github, reason="that the points arrive is proven of each system")
@pytest.mark.parametrize(
    "rubric",
    others_are_more("grade.sh decides it", ["", f"{FOR_THE_REAL_ONE}points: [nonsense\n"], ""),
)
def test_nobody_gets_points_from_a_failure_or_a_mistake_of_the_staff(machine, system, rubric):
    student = machine.submission("echo 'Points: 100'; exit 3")
    points, said = system(machine, HandIn(student, rubric=rubric))
    assert points is None
    assert "not your fault" in said


@pytest.mark.more("the stub proves the systems' part, and tests of attacks grade.sh and the grader")
@by_systems(*SYSTEMS, reason="")
def test_a_real_submission_is_graded_by_the_real_grader(system):
    """A run that is cut short."""
    rubric = """
exercise: turtlesim_challenge
limits: {first_motion_s: 3, rest_s: 1, total_s: 3}
varied_runs: {count: 0}
points: {moves: 5}
"""
    with tempfile.TemporaryDirectory() as folder:
        machine = Machine(Path(folder) / system.__name__, real=True)
        student = machine.folder / "student"
        student.mkdir()
        shutil.copy(SPIRAL, student / "turtle_controller.py")
        points, said = system(machine, HandIn(student, rubric=rubric, pass_points="5"))
        assert points, said
