"""examples/ci: what a course's CI runs, with everything around it imitated.

Most tests use a stub in place of `grader run`; the last ones grade for real.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
import yaml

from grader.strict_json import first_error
from tests.grader.reports.samples import FORMATS
from tests.needs import needs
from tests.tiers import others_are_more

ROOT = Path(__file__).resolve().parents[2]
CI = ROOT / "examples" / "ci"
SCRIPTS = sorted([*CI.rglob("*.sh"), CI / "gradescope" / "run_autograder"])
GITHUB = yaml.safe_load((CI / "github" / "grade.yml").read_text())
GITLAB = yaml.safe_load((CI / "gitlab" / ".gitlab-ci.yml").read_text())
#: Whom the stub runs as where the tests run as root: nobody else has this number.
UID = 50_000 + os.getpid() % 10_000
SOURCE = "/a/release"
SPIRAL = ROOT / "tests" / "submissions" / "quick_spiral.py"

VERDICTS: list[dict[str, Any]] = [
    {
        "check": name,
        "title": f"Does {name}",
        "status": "passed" if score == most else "failed",
        "score": score,
        "max_score": most,
        "rationale": "as seen",
        "help": "",
        "evidence": [],
        "depends_on": [],
    }
    for name, score, most in (("moves", 5, 5), ("spiral", 12.5, 95))
]
RESULT: dict[str, Any] = {
    "schema": "turtlesim-grader/result/v1",
    "exercise": "turtlesim_challenge",
    "submission": "student",
    "score": 17.5,
    "max_score": 100,
    "verdicts": VERDICTS,
    "run": {
        "time": "virtual",
        "outcome": "finished",
        "exit_code": None,
        "ticks": 100,
        "simulated_s": 1.6,
        "wall_s": 0.5,
        "trace_sha256": "0" * 64,
        "isolation": "",
        "flags": [],
    },
    "varied_runs": [],
    "artifacts": {"canvas": "canvas.png"},
}
#: `grader run` for a submission that holds `does.sh`: a sentence of shell that leaves with the code
#: that the grader would; it has $out for its results, $errors for what --error-json would hold, and
#: $tries, a file that lasts. The two descriptors of grade.sh it has not.
STUB_RUN = """
submission=$2
while [ "$1" != --exercise ]; do shift; done
case "$*" in "--exercise $2 --out $4 --json /dev/fd/3 --error-json /dev/fd/4") ;; *) exit 99 ;; esac
export out=$4 tries=$HOME/tries errors=$HOME/errors
mkdir -p "$out"
echo once >>"$tries"
printf '%s' '{result}' >"$out/result.json"
cp {canvas} "$out/canvas.png"
sh "$submission/does.sh" 3>&- 4>&-
code=$?
if [ $code -lt 2 ]; then
    printf '%s' '{result}' >&3
elif [ -f "$errors" ]; then
    cat "$errors" >&4
fi
exit $code
"""


def an_error(whose: str, message: str) -> str:
    """A sentence of shell: an error, as the grader would tell of it."""
    error = {
        "schema": "turtlesim-grader/error/v1",
        "whose": whose,
        "message": message,
        "max_score": 100.0,
    }
    return f"printf %s {shlex.quote(json.dumps(error))} >$errors; exit 2"


class Machine:
    """A machine with the grader installed, and a folder that everybody can go to."""

    def __init__(self, folder: Path, real: bool) -> None:
        self.folder = folder
        self.venv = folder / "venv"
        self.work = folder / "work"
        (self.venv / "bin").mkdir(parents=True)
        (self.venv / "installed-from").write_text(SOURCE)
        shutil.copy(ROOT / "docs" / "spiral.png", folder / "canvas.png")
        python = f'exec env PYTHONPATH={ROOT} {sys.executable} -P "$@"'
        run = STUB_RUN.format(result=json.dumps(RESULT), canvas=folder / "canvas.png")
        # what is not there, and an exercise of one's own, are left to the real one
        is_stubbed = '[ "$1" = run ] && [ -e "$2" ] && [ "${*%exercise.yaml*}" = "$*" ]'
        stub = f"if {is_stubbed}; then\n{run}\nfi\n"
        program(self.venv / "bin" / "python", python)
        program(
            self.venv / "bin" / "grader",
            ("" if real else stub) + python.replace('"$@"', '-m grader "$@"'),
        )
        program(folder / "bin" / "sudo", 'exec "$@"')
        program(folder / "bin" / "gh", f"printf '%s\\n' \"$@\" >{folder}/gh.txt")
        self.env = {
            "PATH": f"{folder / 'bin'}:{os.environ['PATH']}",
            "HOME": str(folder),
            "GRADER_VENV": str(self.venv),
            # a user of its own could not go to the Python that the tests run with
            "GRADER_USER": "" if real else str(UID),
            "GRADER_LIMIT_S": "60",
            "GRADER_SCRIPTS": str(CI),
            "SECRET_TOKEN": "do-not-tell",
        }

    def bash(
        self, *words: str | Path, cwd: Path | None = None, **env: str
    ) -> subprocess.CompletedProcess[str]:
        """Run bash with these words in the environment of a CI job."""
        return subprocess.run(
            ["bash", *words],
            cwd=cwd or self.folder,
            env=self.env | env,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
        )

    def submission(self, does: str) -> Path:
        """A submission for the stub."""
        folder = self.folder / "student"
        folder.mkdir()
        (folder / "does.sh").write_text(does)
        return folder

    def grade(self, does: str, *options: str, **env: str) -> int:
        """grade.sh's exit code."""
        submission = self.submission(does)
        return self.bash(CI / "grade.sh", submission, self.work, *options, **env).returncode

    @property
    def error(self) -> tuple[str, str]:
        """Whose turn it is, and why."""
        error = json.loads((self.work / "error.json").read_text())
        assert first_error("grader.result", "error", error) is None
        return error["whose"], error["message"]


def program(path: Path, script: str) -> None:
    path.parent.mkdir(exist_ok=True)
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(0o755)


@pytest.fixture
def machine() -> Iterator[Machine]:
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o755)
        yield Machine(Path(folder), real=False)


# What the files say


@needs("shellcheck")
@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.name)
def test_scripts_pass_shellcheck(script: Path) -> None:
    shellcheck(script.read_text())


@needs("shellcheck")
@pytest.mark.parametrize(
    "script",
    [
        *(step["run"] for job in GITHUB["jobs"].values() for step in job["steps"] if "run" in step),
        "\n".join([*GITLAB["grade"]["before_script"], *GITLAB["grade"]["script"]]),
    ],
)
def test_scripts_in_workflows_pass_shellcheck(script: str) -> None:
    shellcheck("#!/bin/bash\nset -e\n" + script)


@needs("shellcheck")
def test_the_script_that_vpl_is_to_run_passes_shellcheck(machine: Machine) -> None:
    student = machine.submission("exit 0")
    assert machine.bash(CI / "vpl" / "vpl_evaluate.sh", cwd=student).returncode == 0
    shellcheck((student / "vpl_execution").read_text())


def shellcheck(script: str) -> None:
    check = subprocess.run(["shellcheck", "-"], input=script, capture_output=True, text=True)
    assert check.returncode == 0, check.stdout


@pytest.mark.parametrize(
    ("schema", "file"),
    [("github-workflows", "github/grade.yml"), ("gitlab-ci", "gitlab/.gitlab-ci.yml")],
)
def test_workflows_follow_the_schema(schema: str, file: str) -> None:
    words = ["--builtin-schema", f"vendor.{schema}", str(CI / file)]
    check = subprocess.run([sys.executable, "-m", "check_jsonschema", *words], capture_output=True)
    assert check.returncode == 0, check.stdout


def test_actions_are_pinned_to_commits() -> None:
    used = [
        step["uses"] for job in GITHUB["jobs"].values() for step in job["steps"] if "uses" in step
    ]
    assert used
    assert [
        action for action in used if not re.fullmatch(r"actions/[\w/-]+@[0-9a-f]{40}", action)
    ] == []


def test_the_job_that_runs_students_code_has_no_token_to_write_with() -> None:
    assert GITHUB["permissions"] == {}
    assert GITHUB["jobs"]["grade"]["permissions"] == {"contents": "read"}
    checkout = GITHUB["jobs"]["grade"]["steps"][0]
    assert checkout["with"]["persist-credentials"] is False


def test_what_has_to_be_edited_is_marked() -> None:
    for file in CI.rglob("*"):
        if file.is_file() and file.name != "install.sh":
            before = ""
            for line in file.read_text().splitlines():
                if "example.org" in line:
                    assert "# EDIT:" in before, f"{file}: {line}"
                # an explanation may have several lines
                before = f"{before}{line}" if line.strip().startswith("#") else ""


def test_every_format_that_is_asked_for_exists() -> None:
    text = "".join(file.read_text() for file in CI.rglob("*") if file.is_file())
    asked = {*re.findall(r"--format ([\w-]+)", text), *re.findall(r'report\(work, "(\w+)"', text)}
    assert asked - set(FORMATS) == set()
    assert len(asked) > 6


# grade.sh: whose turn it is


@pytest.mark.parametrize("code", [0, 1])
def test_a_judgement_leaves_its_results(machine: Machine, code: int) -> None:
    assert machine.grade(f"exit {code}", "--fail-under", "60") == code
    assert json.loads((machine.work / "graded" / "result.json").read_text()) == RESULT
    assert not (machine.work / "error.json").exists()


def test_an_unusable_submission_is_told_what_to_mend(machine: Machine) -> None:
    assert machine.grade(an_error("submission", "no .py in it.\nHand in one.")) == 2
    assert machine.error == ("submission", "no .py in it.\nHand in one.")
    assert not (machine.work / "graded").exists()


def test_a_submission_that_is_not_there_is_unusable(machine: Machine) -> None:
    grade = machine.bash(CI / "grade.sh", "package", machine.work, GRADER_USER="")
    assert grade.returncode == 2
    whose, message = machine.error
    assert whose == "submission"
    assert message.startswith("package does not exist.")
    assert message in grade.stderr


@pytest.mark.parametrize(
    "does",
    [
        "exit 3",
        "exit 127",
        "kill -KILL $PPID",
        "exit 2",  # says nothing
        "echo 'grader run: no .py in it.' >&2; exit 2",  # as text
        *(an_error(whose, "It broke.") for whose in ("call", "exercise", "grader")),
    ],
)
def test_the_graders_failures_are_never_the_students(machine: Machine, does: str) -> None:
    assert machine.grade(does) == 3
    whose, message = machine.error
    assert whose != "submission"
    assert message


@pytest.mark.parametrize(
    "does",
    [
        "rm $out/result.json",
        "sed -i 's/17.5/100/' $out/result.json",
        "rm $out/result.json; mkfifo $out/result.json $out/canvas.png",
        "rm -r $out",
        "rm -r $out; echo forged >$out",
        f"{an_error('submission', 'Forged.').partition(';')[0]}",
        "echo forged >&3",
        "echo forged >/dev/fd/3",
    ],
)
def test_what_a_submission_does_to_the_results_changes_no_judgement(
    machine: Machine, does: str
) -> None:
    assert machine.grade(f"({does}) 2>/dev/null; exit 0") == 0
    assert json.loads((machine.work / "graded" / "result.json").read_text()) == RESULT
    assert not [path for path in machine.work.rglob("*") if path.is_fifo()]


@needs("root")
def test_a_submission_cannot_open_what_its_grader_writes_into(machine: Machine) -> None:
    does = "for file in /proc/*/fd/[34]; do (echo forged >>$file); done 2>/dev/null; exit 0"
    assert machine.grade(does) == 0
    assert json.loads((machine.work / "graded" / "result.json").read_text()) == RESULT


def test_a_failure_of_the_grader_is_tried_again(machine: Machine) -> None:
    assert machine.grade('[ "$(wc -l <"$tries")" = 2 ] || exit 3') == 0
    assert (machine.work / "graded" / "result.json").exists()


def test_what_never_ends_is_ended(machine: Machine) -> None:
    assert machine.grade("sleep 1000", GRADER_LIMIT_S="1") == 3
    assert machine.error == ("grader", "killed, or not ready after 1 s")


def test_a_mistake_in_the_exercise_is_the_staffs(machine: Machine) -> None:
    exercise = machine.folder / "exercise.yaml"
    exercise.write_text("points: [nonsense\n")
    assert machine.grade("exit 0", EXERCISE=str(exercise), GRADER_USER="") == 3
    whose, message = machine.error
    assert whose == "exercise"
    assert "is not an exercise" in message


def test_an_old_result_does_not_outlive_a_failure(machine: Machine) -> None:
    (machine.work / "graded").mkdir(parents=True)
    (machine.work / "graded" / "result.json").write_text("{}")
    assert machine.grade("exit 3") == 3
    assert not (machine.work / "graded").exists()


# grade.sh: what a submission can reach


def test_a_submission_sees_nothing_of_the_callers_environment(machine: Machine) -> None:
    assert machine.grade("env >$out/env.txt; pwd >$out/pwd.txt; ls -A . >/dev/null") == 0
    seen = (machine.work / "graded" / "env.txt").read_text()
    assert "do-not-tell" not in seen
    assert str(machine.folder) not in seen
    assert (machine.work / "graded" / "pwd.txt").read_text() == "/\n"


def test_a_submission_cannot_gain_privileges(machine: Machine) -> None:
    assert machine.grade("grep NoNewPrivs /proc/self/status >$out/status.txt") == 0
    assert (machine.work / "graded" / "status.txt").read_text().split() == ["NoNewPrivs:", "1"]


def test_git_data_is_no_part_of_the_copy(machine: Machine) -> None:
    (machine.folder / "student" / ".git").mkdir(parents=True)
    (machine.folder / "student" / "does.sh").write_text('[ ! -e "${0%/*}/.git" ]')
    words = (CI / "grade.sh", machine.folder / "student", machine.work)
    assert machine.bash(*words).returncode == 0


@needs("root")
@pytest.mark.parametrize("place", ["venv/bin/grader", "work/graded/x", "results.json", "student/x"])
def test_a_submission_writes_nowhere_else(machine: Machine, place: str) -> None:
    target = machine.folder / place
    assert machine.grade(f"! echo forged 2>/dev/null >{target}") == 0
    assert not target.exists() or "forged" not in target.read_text()


@needs("root")
def test_links_in_the_results_show_nothing_that_the_submission_could_not_read(
    machine: Machine,
) -> None:
    secret = machine.folder / "secret"
    secret.write_text("do-not-tell")
    secret.chmod(0o600)
    machine.grade(f"ln -s {secret} $out/secret.txt")
    assert "do-not-tell" not in "".join(
        file.read_text(errors="replace") for file in machine.work.rglob("*") if file.is_file()
    )


@needs("pgrep", "root")
def test_nothing_of_a_submission_is_left_running(machine: Machine) -> None:
    assert machine.grade("setsid env -i sleep 1000 </dev/null >/dev/null 2>&1 &") == 0
    running = ["pgrep", "--runstates", "RSD", "-U", str(UID)]  # not what is dead, but not buried
    assert subprocess.run(running).returncode == 1


# install.sh


def test_the_placeholder_is_refused(machine: Machine) -> None:
    source = re.search(r"\S+example.org\S+", (CI / "gradescope" / "setup.sh").read_text())
    assert source
    install = machine.bash(CI / "install.sh", GRADER_SOURCE=source[0].split('"')[-2])
    assert install.returncode == 1
    assert "still the placeholder" in install.stderr


def test_what_is_installed_is_not_installed_again(machine: Machine) -> None:
    install = machine.bash(CI / "install.sh", GRADER_SOURCE=SOURCE)
    assert (install.returncode, install.stderr) == (0, "")
    assert "already" in install.stdout


def test_a_folder_with_something_else_in_it_is_left_alone(machine: Machine) -> None:
    program(machine.folder / "bin" / "python3.12", "exit 0")  # fits
    install = machine.bash(CI / "install.sh", GRADER_SOURCE="/another/release")
    assert install.returncode == 1
    assert "holds something else" in install.stderr
    assert (machine.venv / "bin" / "grader").exists()


# The systems. Each function runs what the system would run, and returns what became of it:
# 0 points or more, None where there is no judgement; and what the student can read.

Outcome = tuple[float | None, str]
UNUSABLE = an_error("submission", 'hand in <one> "file".')


def on_github(machine: Machine, student: Path, settings: dict[str, str]) -> Outcome:
    """Its two jobs, step by step, as `bash -e` in the checkout."""
    grader = student / ".github" / "grader"
    grader.mkdir(parents=True)
    for script in ("grade.sh", "install.sh"):
        shutil.copy(CI / script, grader)
    temp, output, summary = (machine.folder / name for name in ("temp", "output", "summary"))
    temp.mkdir()
    env = {key: str(value) for key, value in GITHUB["env"].items()} | settings
    env |= {"GRADER_SOURCE": SOURCE, "GRADER_VENV": str(machine.venv), "RUNNER_TEMP": str(temp)}
    env |= {"GITHUB_OUTPUT": str(output), "GITHUB_STEP_SUMMARY": str(summary)}
    codes = [
        machine.bash("-e", "-c", step["run"], cwd=student, **env).returncode
        for step in GITHUB["jobs"]["grade"]["steps"]
        if "run" in step
    ]
    code = dict(line.split("=") for line in output.read_text().splitlines())["code"]
    assert any(codes) == (code not in ("0", "1", "2")), "red is the staff's turn"

    # what the artifact carries into a job without a checkout
    fresh = machine.folder / "fresh"
    shutil.copytree(temp / "graded", fresh / "graded")
    env |= {"CODE": code, "GITHUB_REPOSITORY": "course/student", "GITHUB_SHA": "0" * 40}
    (step,) = (step for step in GITHUB["jobs"]["report"]["steps"] if "run" in step)
    report = machine.bash("-e", "-c", step["run"], cwd=fresh, **env)
    assert report.returncode == 0, report.stderr
    asked = (machine.folder / "gh.txt").read_text()
    title = re.search(r"output\[title\]=(.*)", asked)
    conclusion = re.search(r"conclusion=(.*)", asked)
    assert title and conclusion
    if code in ("0", "1"):
        junit_score(temp / "graded" / "junit.xml")
        assert "<html" in (temp / "graded" / "report.html").read_text()
    wanted = {"0": "success", "1": "failure", "2": "failure"}.get(code, "action_required")
    assert conclusion[1] == wanted
    points = re.match(r"([\d.]+)(?: of [\d.]+)? points", title[1])
    return float(points[1]) if points else None, asked + summary.read_text()


def on_gitlab(machine: Machine, student: Path, settings: dict[str, str]) -> Outcome:
    """Its only job, in the project's folder."""
    grader = student / ".gitlab" / "grader"
    grader.mkdir(parents=True)
    for script in ("grade.sh", "install.sh"):
        shutil.copy(CI / script, grader)
    env = {key: str(value) for key, value in GITLAB["variables"].items()} | settings
    env |= {"GRADER_SOURCE": SOURCE, "GRADER_VENV": str(machine.venv)}
    job = GITLAB["grade"]
    script = "\n".join([*job["before_script"], *job["script"]])
    run = machine.bash("-e", "-c", script, cwd=student, **env)
    if run.returncode < 2:
        junit_score(student / job["artifacts"]["reports"]["junit"])
    if run.returncode == job["retry"]["exit_codes"]:
        return None, run.stderr
    points = re.findall(job["coverage"].strip("/"), run.stdout, re.MULTILINE)
    return float(points[-1]), run.stdout + run.stderr


def on_gradescope(machine: Machine, student: Path, settings: dict[str, str]) -> Outcome:
    """A tree like /autograder."""
    root = machine.folder / "autograder"
    (root / "source").mkdir(parents=True)
    for script in ("grade.sh", "install.sh", "gradescope/setup.sh"):
        shutil.copy(CI / script, root / "source")
    if "EXERCISE" in settings:
        shutil.copy(settings["EXERCISE"], root / "source" / "exercise.yaml")
    shutil.copytree(student, root / "submission")
    run = machine.bash(CI / "gradescope" / "run_autograder", AUTOGRADER_ROOT=str(root))
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


def on_classroom50(machine: Machine, student: Path, settings: dict[str, str]) -> Outcome:
    """The unpacked bundle, and the student's checkout as working folder."""
    bundle = machine.folder / "bundle"
    bundle.mkdir()
    for script in ("grade.sh", "install.sh"):
        shutil.copy(CI / script, bundle)
    if "EXERCISE" in settings:
        shutil.copy(settings["EXERCISE"], bundle / "exercise.yaml")
    script = (CI / "classroom50" / "autograder.py").read_text()
    script, edits = re.subn("(?m)^GRADER_SOURCE = .*", f'GRADER_SOURCE = "{SOURCE}"', script)
    assert edits == 1
    (bundle / "autograder.py").write_text(script)
    url = "https://host.invalid/"
    given = {
        "CLASSROOM": "ros",
        "ASSIGNMENT": "spiral",
        "ASSIGNMENT_TYPE": "individual",
        "OWNER": "alice",
        "SUBMISSION_TAG": "submit/2026-06-01T14-32-05Z-a1b2c3d",
        **{name: url + name for name in ("COMMIT_URL", "RELEASE_URL", "REVIEW_URL")},
    }
    run = subprocess.run(
        [sys.executable, bundle / "autograder.py"],
        cwd=student,
        env=machine.env | given,
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


def on_prairielearn(machine: Machine, student: Path, settings: dict[str, str]) -> Outcome:
    """A tree like /grade."""
    root = machine.folder / "grade"
    shutil.copytree(student, root / "student")
    if "EXERCISE" in settings:
        (root / "tests").mkdir()
        shutil.copy(settings["EXERCISE"], root / "tests" / "exercise.yaml")
    run = machine.bash(CI / "prairielearn" / "prairielearn.sh", GRADE_ROOT=str(root))
    file = root / "results" / "results.json"
    assert file.exists() == (run.returncode == 0)
    if run.returncode != 0:
        return None, run.stderr
    result = json.loads(file.read_text())
    if not result["gradable"]:
        return 0, result["format_errors"]
    return result["score"] * 100, result["message"]


def on_autolab(machine: Machine, student: Path, settings: dict[str, str]) -> Outcome:
    """The folder with the Makefile, a tar file, and a zip."""
    place = machine.folder / "autolab"
    shutil.copytree(CI / "autolab", place)
    (place / "autograde-Makefile").rename(place / "Makefile")
    subprocess.run(["tar", "-cf", "autograde.tar", "autograde.sh"], cwd=place, check=True)
    (place / "autograde.sh").unlink()
    if (student / "does.sh").exists():  # the stub does not unpack
        script = subprocess.run(["tar", "-xOf", "autograde.tar"], cwd=place, capture_output=True)
        (place / "autograde.sh").write_bytes(script.stdout.replace(b"handin.zip", b"handin"))
        subprocess.run(["tar", "-cf", "autograde.tar", "autograde.sh"], cwd=place, check=True)
        shutil.copytree(student, place / "handin")
    else:
        shutil.make_archive(str(place / "handin"), "zip", student)
    run = machine.bash("-c", "make", cwd=place, **settings)
    if run.returncode != 0:
        assert "scores" not in run.stdout
        return None, run.stderr
    scores = json.loads(run.stdout.splitlines()[-1])["scores"]
    return sum(scores.values()), run.stdout + run.stderr


def on_vpl(machine: Machine, student: Path, settings: dict[str, str]) -> Outcome:
    """In the folder with the student's files: first the one script, then what that has written."""
    assert machine.bash(CI / "vpl" / "vpl_evaluate.sh", cwd=student).returncode == 0
    run = machine.bash("vpl_execution", cwd=student, **settings)
    grades = re.findall(r"^Grade :=>> (.*)$", run.stdout, re.MULTILINE)
    return float(grades[0]) if grades else None, run.stdout


def junit_score(file: Path) -> float:
    suite = ElementTree.parse(file).getroot().find("testsuite")
    assert suite is not None
    (score,) = (p.get("value") for p in suite.iter("property") if p.get("name") == "score")
    return float(str(score))


System = Callable[[Machine, Path, dict[str, str]], Outcome]
SYSTEMS: list[System] = [
    *(on_github, on_gitlab, on_gradescope, on_classroom50),
    *(on_prairielearn, on_autolab, on_vpl),
]


def by_systems(*kept: System, reason: str) -> pytest.MarkDecorator:
    """Each of them; in `make test` those that are kept."""
    systems = others_are_more(reason, SYSTEMS, *kept)
    return pytest.mark.parametrize("system", systems, ids=lambda system: system.__name__)


each_system = by_systems(*SYSTEMS, reason="")


def worth(system: System) -> float:
    """17.5 points, as that system writes them."""
    return 18 if system is on_classroom50 else 17.5  # which has whole points


#: Of what the script for all of them decides.
one_system = by_systems(SYSTEMS[0], reason="that the points arrive is proven of each system")


@each_system
def test_the_points_arrive(machine: Machine, system: System) -> None:
    points, _ = system(machine, machine.submission("exit 0"), {})
    assert points == worth(system)


@one_system
def test_too_few_points_arrive_as_well(machine: Machine, system: System) -> None:
    points, _ = system(machine, machine.submission("exit 1"), {})
    assert points == worth(system)


@by_systems(*SYSTEMS[:3], reason="how others are told of points is proven by those that arrive")
def test_an_unusable_submission_has_no_points_and_says_why(
    machine: Machine, system: System
) -> None:
    points, said = system(machine, machine.submission(UNUSABLE), {})
    assert points == 0
    assert 'hand in <one> "file".' in said.replace("\\", "")


@one_system
def test_nobody_gets_points_from_a_failure(machine: Machine, system: System) -> None:
    does = "echo 'Grade :=>> 100'; echo '{\"scores\": {\"moves\": 5}}'; echo 'Points: 100'; exit 3"
    points, said = system(machine, machine.submission(does), {})
    assert points is None
    assert "not your fault" in said


@one_system
def test_a_mistake_of_the_staff_is_no_judgement(machine: Machine, system: System) -> None:
    exercise = machine.folder / "exercise.yaml"
    exercise.write_text("points: [nonsense\n")
    points, _ = system(machine, machine.submission("exit 0"), {"EXERCISE": str(exercise)})
    assert points is None


# With the real grader


a_real_system = by_systems(
    SYSTEMS[0], reason="the stub proves the system's own part, one system the real grader's"
)


@a_real_system
def test_a_real_submission_is_graded(system: System) -> None:
    """A run that is cut short."""
    data: dict[str, Any] = {
        "exercise": "turtlesim_challenge",
        "title": "Short",
        "limits": {"first_motion_s": 3, "rest_s": 1, "total_s": 3},
        "varied_runs": {"count": 0},
        "points": {"moves": 5},
    }
    with tempfile.TemporaryDirectory() as folder:
        exercise = Path(folder) / "exercise.yaml"
        exercise.write_text(yaml.safe_dump(data))
        machine = Machine(Path(folder) / system.__name__, real=True)
        student = machine.folder / "student"
        student.mkdir()
        shutil.copy(SPIRAL, student / "turtle_controller.py")
        settings = {"EXERCISE": str(exercise), "PASS_POINTS": "5"}
        points, said = system(machine, student, settings)
        assert points, said
