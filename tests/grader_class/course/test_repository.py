import compileall
import csv
import re
import shlex
import shutil
import subprocess
from importlib.util import find_spec
from pathlib import Path

import pytest
import yaml

from grader.cli import _parser, main
from grader.exercise.loading import load_exercise
from grader.submission.manifest import exercises_named
from grader_class.course import repository
from grader_class.course.repository import KINDS
from grader_class.find import roster
from tests.grader.reports.samples import FORMATS
from tests.grader_class.course.machine import EXERCISES, SOURCE, an_error, course
from tests.needs import needs

each_kind = pytest.mark.parametrize("kind", KINDS)
GITHUB = Path("templates", EXERCISES[1], ".github", "workflows", "grade.yml")
GITLAB = Path("templates", EXERCISES[1], ".gitlab-ci.yml")


def files(kind):
    return sorted(path for path in course(kind).rglob("*") if path.is_file())


def loaded(kind, file):
    return yaml.safe_load((course(kind) / file).read_text(encoding="utf-8"))


def commands(kind):
    """The commands on its README, which are indented, with their continuations."""
    text = (course(kind) / "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"(?m)(?:^ {4,}\S.*\n)+", text)
    return [re.sub(r"(?m)^ {4,7}", "", block) for block in blocks]


@each_kind
def test_every_value_is_filled_in(kind):
    texts = {path: path.read_text(encoding="utf-8") for path in files(kind)}
    assert [path for path, text in texts.items() if "@@" in text] == []
    # the README alone need not say what is installed
    assert any(SOURCE in text for path, text in texts.items() if path.name != "README.md")


@each_kind
def test_each_exercise_has_its_starter_and_a_copy_to_edit(kind):
    for name in EXERCISES:
        slug = name.replace("_", KINDS[kind].slug)
        starter = course(kind) / KINDS[kind].starter.replace("EXERCISE", slug)
        assert exercises_named(starter / "package.xml") == (name,)
        assert (starter / "README.md").is_file()
        rubric = course(kind) / KINDS[kind].rubric.replace("EXERCISE", slug)
        assert load_exercise(rubric).sha256 == load_exercise(name).sha256


@each_kind
def test_the_roster_is_one_that_a_class_is_graded_with(kind):
    read = roster.read_roster(course(kind) / "roster.csv")
    assert [member.person.name for member in read.members] == ["Ada Example"]
    assert "roster.csv" in (course(kind) / ".gitignore").read_text().splitlines()


@each_kind
def test_what_the_readme_names_is_there(kind):
    text = (course(kind) / "README.md").read_text(encoding="utf-8")
    named = re.findall(r"`([\w.-]+/[\w./-]*)`", text.replace("NAME", EXERCISES[1]))
    made = ("build/", "results/", "graded/", "ORG/")
    there = [f"/{path.relative_to(course(kind))}" for path in course(kind).rglob("*")]
    named = [f"/{path.rstrip('/')}" for path in named if not path.startswith(made)]
    assert named
    assert [path for path in named if not any(each.endswith(path) for each in there)] == []


@each_kind
def test_the_commands_on_the_readme_can_be_called(kind):
    text = (course(kind) / "README.md").read_text(encoding="utf-8")
    blocks = commands(kind)
    subprocess.run(["bash", "-n", "-c", "\n".join(blocks)], check=True)
    lines = [line for block in blocks for line in block.splitlines()]
    called = [line for line in lines if line.startswith("grader ")]
    called += re.findall(r"`(grader (?!course)\w+ [^`]+)`", text)
    assert called
    for line in called:
        words = shlex.split(line, comments=True)[1:]
        _parser(words).parse_args(words)


@needs("shellcheck")
@each_kind
def test_scripts_pass_shellcheck(kind):
    scripts = [path for path in files(kind) if re.match(rb"#!/.*sh\n", path.read_bytes())]
    assert scripts and all(path.stat().st_mode & 0o111 for path in scripts)
    for script in (*(path.read_text() for path in scripts), *steps(kind)):
        words = ["shellcheck", "-"]
        check = subprocess.run(words, input=script, capture_output=True, text=True)
        assert check.returncode == 0, check.stdout


def steps(kind):
    """The scripts in a workflow."""
    found = []
    if kind == "github":
        jobs = loaded(kind, GITHUB)["jobs"].values()
        found = [step["run"] for each in jobs for step in each["steps"] if "run" in step]
    elif kind == "gitlab":
        job = loaded(kind, GITLAB)["grade"]
        found = ["\n".join([*job["before_script"], *job["script"]])]
    return [f"#!/bin/bash\nset -e\n{each}" for each in found]


def test_every_format_that_is_asked_for_exists():
    text = "".join(path.read_text(encoding="utf-8") for kind in KINDS for path in files(kind))
    asked = {*re.findall(r"--format ([\w-]+)", text), *re.findall(r'report\(work, "(\w+)"', text)}
    assert asked - set(FORMATS) == set()
    assert len(asked) > 3


def test_what_pip_has_compiled_is_no_part_of_a_course(tmp_path, monkeypatch):
    shutil.copytree(repository.TEMPLATES, tmp_path / "templates")
    assert compileall.compile_dir(tmp_path / "templates", quiet=1)
    monkeypatch.setattr(repository, "TEMPLATES", tmp_path / "templates")
    assert main(["course", "new", str(tmp_path / "course"), "--for", "classroom50"]) == 0
    assert [path.name for path in (tmp_path / "course").rglob("*.py*") if "__" in str(path)] == [
        "__init__.py"
    ]


def test_the_grades_that_github_keeps_are_collected_also_of_what_was_unusable(machine):
    """From downloaded artifacts, whether there are results, errors or both."""
    (block,) = (text for text in commands("github") if "grades.csv" in text)
    collect = block[block.index("find results") :]
    results = machine.folder / "results"
    results.mkdir()

    def collected():
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


@pytest.mark.applies(
    find_spec("check_jsonschema") is not None, reason="our lower bounds are too old for it"
)
@pytest.mark.parametrize(
    ("kind", "schema", "file"),
    [("github", "github-workflows", GITHUB), ("gitlab", "gitlab-ci", GITLAB)],
)
def test_workflows_follow_the_schema(kind, schema, file):
    import check_jsonschema
    from click.testing import CliRunner

    words = ["--builtin-schema", f"vendor.{schema}", str(course(kind) / file)]
    check = CliRunner().invoke(check_jsonschema.main, words)
    assert check.exit_code == 0, check.output


def test_actions_are_pinned_and_the_job_that_runs_students_code_has_no_token_to_write_with():
    workflow = loaded("github", GITHUB)
    steps = [step for job in workflow["jobs"].values() for step in job["steps"]]
    used = [step["uses"] for step in steps if "uses" in step]
    assert used
    assert all(re.fullmatch(r"actions/[\w/-]+@[0-9a-f]{40}", action) for action in used)
    assert workflow["permissions"] == {}
    assert workflow["jobs"]["grade"]["permissions"] == {"contents": "read"}
    steps = workflow["jobs"]["grade"]["steps"]
    assert steps[0]["with"]["persist-credentials"] is False
    assert [step["name"] for step in steps if "secrets." in str(step)] == ["Install the grader"]


def test_templates_are_pushed_and_pushed_again_after_an_edit(machine):
    """To folders in place of the system; the second time on top of what is there by then."""
    laid, hub = machine.lay("gitlab"), machine.folder / "hub"
    readme, there = laid / "templates" / EXERCISES[1] / "README.md", hub / f"{EXERCISES[1]}.git"
    who = [f"GIT_{who}_{what}" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")]

    def done(*words):
        run = machine.bash(*words, **dict.fromkeys(who, "staff@x"))
        assert run.returncode == 0, run.stderr
        return run.stdout

    def published():
        done(laid / "publish.sh", str(hub), EXERCISES[1])
        return done("-c", f"git -C {there} log --name-only --format=%s main").splitlines()

    done("-c", f"git -c init.defaultBranch=main init --quiet --bare {there}")
    first = published()
    assert {".gitlab-ci.yml", ".gitlab/grader/rubric.yaml", "package.xml"} <= set(first)
    assert published() == first
    readme.write_text("edited")
    assert published() == [f"The exercise {EXERCISES[1]}", "", "README.md", *first]

    adds = "echo theirs >LICENSE && git add LICENSE && git commit -qm Licence && git push -q"
    done("-c", f"git clone --quiet --branch=main {there} clone && cd clone && {adds}")
    before = published()
    assert "LICENSE" in before
    readme.write_text("edited again")
    assert published() == [f"The exercise {EXERCISES[1]}", "", "README.md", *before]
