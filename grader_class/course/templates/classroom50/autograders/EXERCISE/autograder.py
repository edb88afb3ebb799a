"""Classroom 50 runs this in the student's checkout after every push.

Lies in the classroom50 repository as CLASSROOM/autograders/ASSIGNMENT/autograder.py, beside
install.sh, grade.sh and rubric.yaml, the exercise. Leaves result.json and release-body.md, and
graded/canvas.png and graded/report.html, which `release_assets` can attach.

The exit code is 0 when there is a judgement, also when the submission cannot be used (0 points);
anything else tells Classroom 50 that the grader failed.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

# the grader, as pip installs it
GRADER_SOURCE = "@@source"
# where the student's package or node is in the checkout
SUBMISSION = "."

BUNDLE = Path(__file__).resolve().parent
VENV = os.environ.get("GRADER_VENV", "/opt/turtlesim-grader")
SETTINGS = {
    "GRADER_SOURCE": GRADER_SOURCE,
    "GRADER_VENV": VENV,
    "EXERCISE": str(BUNDLE / "rubric.yaml"),
}


def as_root(script: str, *words: str) -> int:
    """Run one of our scripts; its exit code. Without any root it does what it can."""
    sudo = ["sudo"] if os.geteuid() and shutil.which("sudo") else []
    settings = ["env", *(f"{name}={value}" for name, value in SETTINGS.items())]
    return subprocess.run([*sudo, *settings, "bash", str(BUNDLE / script), *words]).returncode


def report(work: Path, name: str, file: Path, of: str = "graded/result.json") -> None:
    """Write the result, or the error, in a format of `grader report`."""
    command = [f"{VENV}/bin/grader", "report", str(work / of)]
    subprocess.run([*command, "--format", name, "--out", str(file)], check=True)


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
            report(work, "classroom50", Path("result.json"), of="error.json")
            report(work, "markdown", Path("release-body.md"), of="error.json")
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
            if file.exists():  # the submission could remove the picture
                shutil.copyfile(file, kept / file.name)
    return 0


if __name__ == "__main__":
    sys.exit(main())
