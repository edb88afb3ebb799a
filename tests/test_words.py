"""The grader knows of turtles in one scene and in the exercises only.

A second scene, with a robot in it, needs then nothing but a folder of its own.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).parents[1]
SOURCES = {".py", ".json", ".yaml", ".xml", ".html", ".css", ".js", ".md"}
WORD = re.compile("turtle", re.IGNORECASE)

#: Here a turtle is a turtle: the scene, what is asked about it, what its tests are driven with.
AT_HOME = ("grader/scenes/turtlesim/", "grader/exercises/", "grader/testing")

#: Names, not turtles; they may stand anywhere.
NAMES = (
    r"\bturtlesim_py\b",  # packages of ours
    r"\bturtlesim_challenge\b",
    r"\bturtlesim-py maintainers\b",
    r"\bturtlesim[-_]grader(\b|_)",  # ids of files and of processes
)

#: Where a name is meant that only these files may know.
ALLOWED = {
    # the scene that is taken where none is named
    "grader/scenes/__init__.py": [r'NAMES = \("turtlesim",', r'"turtlesim", "turtlesim_msgs"'],
    "grader/exercise/exercise.py": [r'scene: str = "turtlesim"'],
    "grader/exercise/building.py": [r'"scene", "turtlesim"'],
    "grader/run/plan.py": [r'scene: str = "turtlesim"'],
    "grader/recording/recording.py": [r'scene: str = "turtlesim"'],
    "grader/recording/folder.py": [r'FIRST_SCENE = "turtlesim"'],
    "grader/recording/recording.schema.json": [r"absent: turtlesim"],
    # the challenge, and the name that it asks a program to have
    "grader/package.xml": [r"for the turtlesim challenge"],
    "grader/cli/__init__.py": [r"Grade the turtlesim challenge"],
    "grader/cli/grade_one.py": [r"alice/turtle_controller\.py"],
    "grader/submission/finding.py": [r"turtle_controller"],
    "grader/submission/folder.py": [r'USUAL_NAME: Final = "turtle_controller"'],
    "grader/submission/entry_points.py": [r"turtle_controller"],
    "grader/submission/setup_files.py": [r"turtle_controller"],
    # the simulator that students' launch files start
    "grader/submission/launching.py": [r'_SIMULATOR = \("turtlesim", "turtlesim_node"\)'],
    "grader/submission/start.py": [r"turtle_controller"],
    # packages of ROS that launch files may start nodes of
    "grader/scenes/package/examining/known.py": [r'"turtlesim"', r'"turtlebot3_\w+"'],
}

#: The name of a class of elements in the page, whose bytes are to stay as they were.
STILL_THERE = {
    "grader/reports/page/templates/page.css": [r"^\.turtle \.(skin|shell|mark)"],
    "grader/reports/page/templates/page.js": [r'this\.turtles|"\.turtle"|\bturtle\b'],
}


class Line(NamedTuple):
    """A line of a source that says the word."""

    file: str
    number: int
    text: str

    def says_it_beside(self, patterns: list[str]) -> bool:
        """Whether the word is still in it when what matches the patterns is taken away."""
        rest = self.text
        for pattern in patterns:
            rest = re.sub(pattern, "", rest, flags=re.IGNORECASE)
        return WORD.search(rest) is not None


def lines() -> Iterator[Line]:
    for path in sorted((ROOT / "grader").rglob("*")):
        file = path.relative_to(ROOT).as_posix()
        if path.suffix in SOURCES and not file.startswith(AT_HOME):
            for number, text in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                if WORD.search(text):
                    yield Line(file, number, text)


def test_nothing_outside_its_scene_and_the_exercises_says_turtle():
    found = [
        f"{line.file}:{line.number}: {line.text.strip()}"
        for line in lines()
        if line.says_it_beside(
            [*NAMES, *ALLOWED.get(line.file, []), *STILL_THERE.get(line.file, [])]
        )
    ]
    assert found == []


def test_no_file_outside_of_them_is_called_so():
    files = (path.relative_to(ROOT).as_posix() for path in (ROOT / "grader").rglob("*"))
    assert [f for f in files if not f"{f}/".startswith(AT_HOME) and WORD.search(f)] == []


@pytest.mark.parametrize(
    ("file", "pattern"),
    [
        (file, pattern)
        for file, patterns in [*ALLOWED.items(), *STILL_THERE.items()]
        for pattern in patterns
    ],
)
def test_an_exception_that_nothing_needs_is_no_exception(file, pattern):
    text = (ROOT / file).read_text(encoding="utf-8")
    assert re.search(pattern, text, re.IGNORECASE | re.MULTILINE)
