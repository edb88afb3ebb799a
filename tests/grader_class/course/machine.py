"""A machine that grades by what `grader course new` writes; a stub may stand for `grader run`."""

import hashlib
import json
import os
import shlex
import shutil
import subprocess
import sys

from grader.cli import main
from grader.system.strict_json import first_error
from tests import once
from tests.grader.reports import samples
from tests.programs import ROOT

#: Whom the stub runs as where the tests run as root: nobody else has this number.
UID = 50_000 + os.getpid() % 10_000
SOURCE = "/a/release[jazzy]"
#: In each course of these tests; the stub, and most tests, take the first.
EXERCISES = ("turtlesim_challenge", "talker")
#: A rubric that begins so is not for the stub.
FOR_THE_REAL_ONE = "# not for the stub\n"


def course(kind):
    """The repository of a course of this kind, which no test changes."""

    def make(folder):
        words = ["--for", kind, "--exercises", *EXERCISES, "--source", SOURCE]
        assert main(["course", "new", str(folder), *words]) == 0

    return once.folder(make, "course", kind, EXERCISES, SOURCE)


def scripts():
    """The folder of grade.sh and install.sh, which are the same in all."""
    return course("gradescope") / "autograders" / EXERCISES[0]


RESULT = samples.result(
    samples.verdict("moves", score=5, max_score=5),
    samples.verdict("spiral", "failed", 12.5, max_score=95),
    submission="student",
    artifacts={"canvas": "canvas.png"},
)
#: `grader run` for a submission that holds `does.sh`: a sentence of shell that leaves with the code
#: that the grader would; it has $out for its results, $errors for what --error-json would hold, and
#: $tries, a file that lasts. The two descriptors of grade.sh it has not.
STUB_RUN = """
submission=$2
while [ "$1" != --exercise ]; do shift; done
case "$*" in "--exercise $2 --out $4 --json /dev/fd/3 --error-json /dev/fd/4") ;; *) exit 99 ;; esac
cp "$2" {seen}
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


def an_error(whose, message):
    """A sentence of shell: an error, as the grader would tell of it."""
    error = {"schema": "turtlesim-grader/error/v1", "whose": whose, "message": message}
    return f"printf %s {shlex.quote(json.dumps(error | {'max_score': 100.0}))} >$errors; exit 2"


class Machine:
    """A machine with the grader installed, and a folder that everybody can go to."""

    def __init__(self, folder, real):
        self.folder = folder
        self.venv = folder / "venv"
        self.work = folder / "work"
        (self.venv / "bin").mkdir(parents=True)
        digest = hashlib.sha256(SOURCE.encode()).hexdigest()
        (self.venv / "installed-from").write_text(f"{digest}  -\n")
        self.seen = folder / "seen"
        self.seen.mkdir()
        self.seen.chmod(0o777)
        shutil.copy(ROOT / "docs" / "spiral.png", folder / "canvas.png")
        python = f'exec env PYTHONPATH={ROOT} {sys.executable} -P "$@"'
        run = STUB_RUN.format(
            result=json.dumps(RESULT), canvas=folder / "canvas.png", seen=self.seen
        )
        # what is not there, and some rubrics, are left to the real one
        marked = FOR_THE_REAL_ONE.strip()
        is_stubbed = f'[ "$1" = run ] && [ -e "$2" ] && ! grep -qs "{marked}" "$HOME/rubric.yaml"'
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
            "EXERCISE": str(scripts() / "rubric.yaml"),
            "SECRET_TOKEN": "do-not-tell",
        }

    def lay(self, kind, rubric=""):
        """A course of its own for this machine; its exercises as in `rubric`, if that is given."""
        folder = self.folder / "course"
        shutil.copytree(course(kind), folder)
        if rubric:
            for path in folder.rglob("rubric.yaml"):
                path.write_text(rubric)
        return folder

    def bash(self, *words, cwd=None, **env):
        """Run bash with these words in the environment of a CI job."""
        return subprocess.run(
            ["bash", *words],
            cwd=cwd or self.folder,
            env=self.env | env,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
        )

    def submission(self, does):
        """A submission for the stub."""
        folder = self.folder / "student"
        folder.mkdir()
        (folder / "does.sh").write_text(does)
        return folder

    def grade(self, does, *options, **env):
        """grade.sh's exit code."""
        submission = self.submission(does)
        return self.bash(scripts() / "grade.sh", submission, self.work, *options, **env).returncode

    @property
    def error(self):
        """Whose turn it is, and why."""
        error = json.loads((self.work / "error.json").read_text())
        assert first_error("grader.exercise.result", "error", error) is None
        return error["whose"], error["message"]


def program(path, script):
    path.parent.mkdir(exist_ok=True)
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(0o755)
