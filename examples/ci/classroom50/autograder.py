"""Classroom 50 runs this in the student's checkout after every push.

Goes into the classroom50 repository as CLASSROOM/autograders/ASSIGNMENT/autograder.py, beside
install.sh and grade.sh (and an edited exercise.yaml, if there is one). Leaves result.json and
release-body.md, and graded/canvas.png and graded/report.html, which `release_assets` can attach.

The exit code is 0 when there is a judgement, also when the submission cannot be used (0 points);
anything else tells Classroom 50 that the grader failed.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import tempfile
from datetime import UTC, datetime
from pathlib import Path

# EDIT: the grader, as pip installs it: a git URL with a tag
GRADER_SOURCE = "git+https://example.org/REPLACE-ME.git@TAG"
# EDIT: where the student's package or node is in the checkout
SUBMISSION = "."

BUNDLE = Path(__file__).resolve().parent
VENV = os.environ.get("GRADER_VENV", "/opt/turtlesim-grader")
EXERCISE_FILE = BUNDLE / "exercise.yaml"
EXERCISE = str(EXERCISE_FILE) if EXERCISE_FILE.exists() else "turtlesim_challenge"
SETTINGS = {"GRADER_SOURCE": GRADER_SOURCE, "GRADER_VENV": VENV, "EXERCISE": EXERCISE}


def as_root(script: str, *words: str) -> int:
    """Run one of our scripts; its exit code. Without any root it does what it can."""
    sudo = ["sudo"] if os.geteuid() and shutil.which("sudo") else []
    settings = ["env", *(f"{name}={value}" for name, value in SETTINGS.items())]
    return subprocess.run([*sudo, *settings, "bash", str(BUNDLE / script), *words]).returncode


def report(work: Path, name: str, file: Path) -> None:
    """Write the result in a format of `grader report`."""
    command = [f"{VENV}/bin/grader", "report", str(work / "graded" / "result.json")]
    subprocess.run([*command, "--format", name, "--out", str(file)], check=True)


def write_unusable(message: str) -> None:
    """0 points, and what the student has to mend."""
    env = os.environ
    code = (
        "import sys; from grader import exercise as e; print(*e.load(sys.argv[1]).points.values())"
    )
    printed = subprocess.check_output([f"{VENV}/bin/python", "-P", "-c", code, EXERCISE], text=True)
    most = round(sum(map(float, printed.split())))
    test = {"test-name": "submission", "passed": False, "score": 0, "max-score": most}
    result = {
        "schema": "classroom50/result/v1",
        "classroom": env["CLASSROOM"],
        "assignment": env["ASSIGNMENT"],
        "assignment_type": env.get("ASSIGNMENT_TYPE") or "individual",
        "owner": env.get("OWNER") or env["USERNAME"],
        "submission": env["SUBMISSION_TAG"],
        "commit": env["COMMIT_URL"],
        "release": env["RELEASE_URL"],
        "review": env.get("REVIEW_URL") or env["COMMIT_URL"],
        "datetime": datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ"),
        "score": 0,
        "max-score": most,
        "tests": [{**test, "message": message}],
    }
    Path("result.json").write_text(json.dumps(result, indent=2) + "\n", encoding="utf-8")
    quoted = "".join(f"    {line}\n" for line in message.splitlines())
    body = f"## 0 of {most} points: this cannot be graded\n\n{quoted}\nMend that, and push again.\n"
    Path("release-body.md").write_text(body, encoding="utf-8")


def main() -> int:
    """Grade the checkout that this runs in; see above for the exit code."""
    if as_root("install.sh") != 0:
        return 3
    for path in (Path("result.json"), Path("release-body.md")):
        path.unlink(missing_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        code = as_root("grade.sh", SUBMISSION, folder)
        if code == 2:
            write_unusable((work / "message.txt").read_text(encoding="utf-8"))
            return 0
        if code not in (0, 1):
            return code
        report(work, "classroom50", Path("result.json"))
        report(work, "markdown", Path("release-body.md"))
        report(work, "html", work / "report.html")
        kept = Path("graded")
        if kept.is_symlink() or kept.is_file():
            kept.unlink()
        kept.mkdir(exist_ok=True)
        for file in (work / "graded" / "canvas.png", work / "report.html"):
            (kept / file.name).unlink(missing_ok=True)
            shutil.copyfile(file, kept / file.name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
