"""The files of a course: what they say, and that they are what each system asks for."""

from __future__ import annotations

import compileall
import csv
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import yaml

from grader.batch.find import roster
from grader.cli import _parser, main
from grader.course import repository
from grader.course.kinds import KINDS
from grader.exercise.loading import load_exercise
from grader.submission.manifest import exercises_named
from tests.grader.course.machine import EXERCISES, SOURCE, Machine, an_error, course
from tests.grader.reports.samples import FORMATS
from tests.needs import needs

each_kind = pytest.mark.parametrize("kind", KINDS)
GITHUB = Path("templates", EXERCISES[1], ".github", "workflows", "grade.yml")
GITLAB = Path("templates", EXERCISES[1], ".gitlab-ci.yml")


def files(kind: str) -> list[Path]:
    return sorted(path for path in course(kind).rglob("*") if path.is_file())


def loaded(kind: str, file: Path) -> Any:
    return yaml.safe_load((course(kind) / file).read_text(encoding="utf-8"))


def commands(kind: str) -> list[str]:
    """The commands on its README, which are indented, with their continuations."""
    text = (course(kind) / "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"(?m)(?:^ {4,}\S.*\n)+", text)
    return [re.sub(r"(?m)^ {4,7}", "", block) for block in blocks]


# What all have


@each_kind
def test_every_value_is_filled_in(kind: str) -> None:
    assert [path for path in files(kind) if "@@" in path.read_text(encoding="utf-8")] == []
    # the README alone need not say what is installed
    assert any(
        SOURCE in path.read_text(encoding="utf-8")
        for path in files(kind)
        if path.name != "README.md"
    )


@each_kind
def test_each_exercise_has_its_starter_and_a_copy_to_edit(kind: str) -> None:
    for name in EXERCISES:
        slug = name.replace("_", KINDS[kind].slug)
        starter = course(kind) / KINDS[kind].starter.replace("EXERCISE", slug)
        assert exercises_named(starter / "package.xml") == (name,)
        assert (starter / "README.md").is_file()
        rubric = course(kind) / KINDS[kind].rubric.replace("EXERCISE", slug)
        assert load_exercise(rubric).sha256 == load_exercise(name).sha256


@each_kind
def test_the_roster_is_one_that_a_class_is_graded_with(kind: str) -> None:
    read = roster.read_roster(course(kind) / "roster.csv")
    assert [member.person.name for member in read.members] == ["Ada Example"]
    assert "roster.csv" in (course(kind) / ".gitignore").read_text().splitlines()


@each_kind
def test_what_the_readme_names_is_there(kind: str) -> None:
    text = (course(kind) / "README.md").read_text(encoding="utf-8")
    named = re.findall(r"`([\w.-]+/[\w./-]*)`", text.replace("NAME", EXERCISES[1]))
    made = ("build/", "results/", "graded/", "ORG/")
    there = [f"/{path.relative_to(course(kind))}" for path in course(kind).rglob("*")]
    named = [f"/{path.rstrip('/')}" for path in named if not path.startswith(made)]
    assert named
    assert [path for path in named if not any(each.endswith(path) for each in there)] == []


@each_kind
def test_the_grader_s_commands_on_the_readme_can_be_called(kind: str) -> None:
    text = (course(kind) / "README.md").read_text(encoding="utf-8")
    lines = [line for block in commands(kind) for line in block.splitlines()]
    called = [line for line in lines if line.startswith("grader ")]
    called += re.findall(r"`(grader (?!course)\w+ [^`]+)`", text)
    assert called
    for line in called:
        words = shlex.split(line, comments=True)[1:]
        _parser(words).parse_args(words)


@each_kind
def test_the_commands_on_the_readme_are_shell(kind: str) -> None:
    for block in commands(kind):
        subprocess.run(["bash", "-n", "-c", block], check=True)


@needs("shellcheck")
@each_kind
def test_scripts_pass_shellcheck(kind: str) -> None:
    scripts = [path for path in files(kind) if re.match(rb"#!/.*sh\n", path.read_bytes())]
    assert scripts and all(path.stat().st_mode & 0o111 for path in scripts)
    check = subprocess.run(["shellcheck", *scripts], capture_output=True, text=True)
    assert check.returncode == 0, check.stdout


def test_every_format_that_is_asked_for_exists() -> None:
    text = "".join(path.read_text(encoding="utf-8") for kind in KINDS for path in files(kind))
    asked = {*re.findall(r"--format ([\w-]+)", text), *re.findall(r'report\(work, "(\w+)"', text)}
    assert asked - set(FORMATS) == set()
    assert len(asked) > 3


def test_what_pip_has_compiled_is_no_part_of_a_course(tmp_path: Path, monkeypatch) -> None:
    shutil.copytree(repository.TEMPLATES, tmp_path / "templates")
    assert compileall.compile_dir(tmp_path / "templates", quiet=1)
    monkeypatch.setattr(repository, "TEMPLATES", tmp_path / "templates")
    assert main(["course", "new", str(tmp_path / "course"), "--for", "classroom50"]) == 0
    assert [path.name for path in (tmp_path / "course").rglob("*.py*") if "__" in str(path)] == [
        "__init__.py"
    ]


# What one kind has


def test_the_grades_that_github_keeps_are_collected_also_of_what_was_unusable(
    machine: Machine,
) -> None:
    """From downloaded artifacts, whether there are results, errors or both."""
    (block,) = (text for text in commands("github") if "grades.csv" in text)
    collect = block[block.index("find results") :]
    results = machine.folder / "results"
    results.mkdir()

    def collected() -> list[tuple[str, str]]:
        path = f"{machine.venv / 'bin'}:{machine.env['PATH']}"
        done = machine.bash("-e", "-o", "pipefail", "-c", collect, PATH=path)
        assert done.returncode == 0, done.stderr
        rows = csv.DictReader((results / "grades.csv").read_text().splitlines())
        return sorted((row["submission"], row["score"]) for row in rows)

    for student, does in (("ada", "exit 0"), ("bob", an_error("submission", "it is empty"))):
        machine.grade(does)  # what lies in its folder is the artifact
        machine.work.rename(results / student)
        shutil.rmtree(machine.folder / "student")
    assert collected() == [("bob", "0"), ("student", "17.5")]
    (results / "ada").rename(machine.folder / "ada")
    assert collected() == [("bob", "0")]
    shutil.rmtree(results / "bob")
    (machine.folder / "ada").rename(results / "ada")
    assert collected() == [("student", "17.5")]


@pytest.mark.parametrize(
    ("kind", "schema", "file"),
    [("github", "github-workflows", GITHUB), ("gitlab", "gitlab-ci", GITLAB)],
)
def test_workflows_follow_the_schema(kind: str, schema: str, file: Path) -> None:
    words = ["--builtin-schema", f"vendor.{schema}", str(course(kind) / file)]
    check = subprocess.run([sys.executable, "-m", "check_jsonschema", *words], capture_output=True)
    assert check.returncode == 0, check.stdout


@needs("shellcheck")
def test_scripts_in_workflows_pass_shellcheck() -> None:
    jobs, job = loaded("github", GITHUB)["jobs"], loaded("gitlab", GITLAB)["grade"]
    scripts = [step["run"] for each in jobs.values() for step in each["steps"] if "run" in step]
    for script in (*scripts, "\n".join([*job["before_script"], *job["script"]])):
        shellcheck("#!/bin/bash\nset -e\n" + script)


def shellcheck(script: str) -> None:
    check = subprocess.run(["shellcheck", "-"], input=script, capture_output=True, text=True)
    assert check.returncode == 0, check.stdout


def test_actions_are_pinned_to_commits() -> None:
    jobs = loaded("github", GITHUB)["jobs"]
    used = [step["uses"] for job in jobs.values() for step in job["steps"] if "uses" in step]
    assert used
    assert [
        action for action in used if not re.fullmatch(r"actions/[\w/-]+@[0-9a-f]{40}", action)
    ] == []


def test_the_job_that_runs_students_code_has_no_token_to_write_with() -> None:
    workflow = loaded("github", GITHUB)
    assert workflow["permissions"] == {}
    assert workflow["jobs"]["grade"]["permissions"] == {"contents": "read"}
    steps = workflow["jobs"]["grade"]["steps"]
    assert steps[0]["with"]["persist-credentials"] is False
    assert [step["name"] for step in steps if "secrets." in str(step)] == ["Install the grader"]


@needs("git")
def test_templates_are_pushed_and_pushed_again_after_an_edit(machine: Machine) -> None:
    """To folders in place of the system; the second time on top of what is there by then."""
    laid = machine.lay("gitlab")
    address = machine.folder / "hub"
    there = address / f"{EXERCISES[1]}.git"
    git = ["git", "-c", "init.defaultBranch=main"]
    subprocess.run([*git, "init", "--quiet", "--bare", there], check=True)
    env = {
        f"GIT_{who}_{what}": "staff@x"
        for who in ("AUTHOR", "COMMITTER")
        for what in ("NAME", "EMAIL")
    }

    def published() -> list[str]:
        words = (laid / "publish.sh", f"{address}", EXERCISES[1])
        done = machine.bash(*words, **env)
        assert done.returncode == 0, done.stderr
        listed = subprocess.run(
            ["git", "-C", there, "log", "--name-only", "--format=%s", "main"],
            capture_output=True,
            text=True,
            check=True,
        )
        return listed.stdout.splitlines()

    first = published()
    assert {".gitlab-ci.yml", ".gitlab/grader/rubric.yaml", "package.xml"} <= set(first)
    assert published() == first
    (laid / "templates" / EXERCISES[1] / "README.md").write_text("edited")
    assert published() == [f"The exercise {EXERCISES[1]}", "", "README.md", *first]

    clone = machine.folder / "clone"  # what somebody adds there
    subprocess.run(["git", "clone", "--quiet", "--branch=main", there, clone], check=True)
    (clone / "LICENSE").write_text("theirs")
    for words in (["add", "LICENSE"], ["commit", "-qm", "A licence"], ["push", "-q"]):
        subprocess.run(["git", "-C", clone, *words], check=True, env=os.environ | env)
    before = published()
    assert "LICENSE" in before
    (laid / "templates" / EXERCISES[1] / "README.md").write_text("edited again")
    assert published() == [f"The exercise {EXERCISES[1]}", "", "README.md", *before]
