"""A class on the real command line, and what of its folder is the same each time."""

import csv
import io
import os
import re
import sys
from contextlib import redirect_stderr, redirect_stdout
from dataclasses import dataclass
from pathlib import Path

from grader.cli import main
from grader.run.processes import levels
from grader_class import grade, pool
from tests.programs import ROOT

CONTROLLER = (ROOT / "tests" / "submissions" / "square_controller.py").read_text(encoding="utf-8")
#: Only what hangs takes so long [s].
DEADLINE_S = 240.0
#: When it was run, and how long that took.
CLOCKS = re.compile(rb'("wall_s"|"date"): [^,\n]+')
OF_ALL = ("class.json", "gradebook.csv", "gradebook.jsonl", "index.html")
#: Of each student; the page tells how long the run took, as the result does.
EACH = ("entry.json", "result.json", "output.txt", "canvas.png")
ENV = {
    **os.environ,
    "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]),
    "PYTHONUNBUFFERED": "1",
}


@dataclass(frozen=True)
class Class:
    """Submissions, and the exercise that they are for."""

    handed_in: Path
    exercise: Path

    def words(self, out):
        """What `grader batch` is to be told."""
        return self.handed_in, "--out", out, "--exercise", self.exercise


def command(*words):
    return [sys.executable, "-P", "-m", "grader", "batch", *map(str, words)]


def batch(*words):
    """Call `grader batch` in this process; the exit code, and what it said."""
    said = io.StringIO()
    with redirect_stdout(said), redirect_stderr(said):
        # one at a time: another worker of the tests has the other core
        code = main(["batch", *map(str, words), "--jobs", "1"])
    return code, said.getvalue()


def work_here(patch):
    """Have the workers' work done in this process: a start of one takes longer than most of it."""
    patch.setattr(levels, "_only", "")
    patch.setattr(pool, "work", lambda tasks, *_, **__: ((t, grade.done(t)) for t in tasks))


def told(out):
    """What a class has come to, but for when that was, and how long it took."""
    files = [out / name for name in OF_ALL]
    files += [path for name in EACH for path in sorted(out.glob(f"submissions/*/{name}"))]
    return {
        path.relative_to(out).as_posix(): CLOCKS.sub(rb"\1: -", path.read_bytes()) for path in files
    }


def rows(path):
    found = csv.DictReader(path.read_text("utf-8-sig").splitlines())
    return {next(iter(row.values())): row for row in found}
