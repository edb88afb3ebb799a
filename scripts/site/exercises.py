"""Makes the sheet of each of our exercises, by the command that makes them for students."""

from __future__ import annotations

import contextlib
import io
import tempfile
from collections.abc import Iterable
from pathlib import Path

from grader import cli
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load_exercise
from grader.text import points

#: The folder that a student is told to make.
FOLDER = "my_solution"
#: What an exercise runs beside -> the heading of those that do, in the order of the page.
BESIDE = {
    "turtlesim": "Beside the turtles",
    "graph": "Beside other nodes",
    "robot": "Beside a robot",
    "package": "Packages, in which nothing is started",
}
INTRODUCTION = """# Exercises

Each page is what a student gets: `grader new DIR --exercise NAME` writes it, with the files to
begin with, and `grader run DIR` grades by it; `--lang` shows it in French or Chinese. To change
points, tolerances or the task, edit a copy; to write your own: [for any node](../docs/any-node.md),
or [with checks in Python](../docs/write-an-exercise.md).
"""


def lay_out(into: Path, names: Iterable[str]) -> None:
    """Write a page for each exercise, and one that lists them."""
    into.mkdir(parents=True)
    listed: dict[str, list[Exercise]] = {scene: [] for scene in BESIDE}
    for name in names:
        exercise = load_exercise(name)
        listed[exercise.scene].append(exercise)
        heading, _, rest = sheet(name).partition("\n")
        made_by = f"The sheet of `{name}`, as this writes it:\n\n    {' '.join(command(name))}"
        (into / f"{name}.md").write_text(f"{heading}\n\n{made_by}\n{rest}", encoding="utf-8")
    parts = [INTRODUCTION]
    for scene, exercises in listed.items():
        parts.append(f"\n## {BESIDE[scene]}\n\n| exercise | name | points |\n|---|---|---:|")
        for exercise in exercises:
            title, worth = str(exercise.title), points(exercise.max_score)
            parts.append(f"| [{title}]({exercise.name}.md) | `{exercise.name}` | {worth} |")
    (into / "index.md").write_text("\n".join(parts) + "\n", encoding="utf-8")


def command(name: str) -> list[str]:
    """Return the command that writes the sheet of an exercise."""
    return ["grader", "new", FOLDER, "--exercise", name]


def sheet(name: str) -> str:
    """Return the sheet of an exercise in English, as `grader new` writes it."""
    told = io.StringIO()
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        with contextlib.redirect_stdout(told), contextlib.redirect_stderr(told):
            code = cli.main([*command(name)[1:], "--lang", "en"])
        if code:
            raise SystemExit(f"{' '.join(command(name))} ended with {code}:\n{told.getvalue()}")
        return Path(FOLDER, "README.md").read_text(encoding="utf-8")
