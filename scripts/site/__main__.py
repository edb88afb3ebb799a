"""Builds the site: `make docs`.

In build/site, `pages/` has the repository's pages, the sheets of the exercises, the API and the
gallery; `html/` is the site that Zensical makes of them, which checks every link.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterable, Iterator
from importlib import import_module
from inspect import ismodule
from itertools import pairwise
from pathlib import Path
from typing import Any

from markdown_it import MarkdownIt

from grader import cli
from grader.exercise.loading import load_exercise
from grader.text.strings import points
from tests.browser import BROWSER, open_browser
from tests.hand_ins import SUBMISSIONS
from turtlesim_py import scenario

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
OUT = ROOT / "build" / "site"
#: Where a link of a page leads: `](PATH#ANCHOR)`.
LINK = re.compile(r"\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^()\s#:]+)(#[^()\s]*)?\)")
MARKER = re.compile(r" *((?:[-*+]|\d+[.)]) +)")
#: How Zensical colours what it tells, letter by letter.
COLOURS = re.compile(r"\x1b\[[0-9;]*m")
EXERCISES = """# Exercises

Each page is what a student gets: `grader new DIR --exercise NAME` writes it, with the files to
begin with, and `grader run DIR` grades by it. To change points, tolerances or the task, edit a
copy; [how to write your own](../docs/write-an-exercise.md).

| exercise | name | points |
|---|---|---:|
"""
API = "# The Python API\n\nTo grade, to write checks, to try them: [how](docs/python-api.md).\n"
#: The packages whose stubs say what is public; that of authors first.
FACES = (
    *("grader", "grader.testing", "grader.exercise", "grader.scenes", "grader.recording"),
    *("grader.reports", "grader.submission", "grader.run", "grader.system", "grader.text"),
)
#: A controller that draws its spiral in seconds.
MISTAKES = SUBMISSIONS / "first_lines"
QUICK = (SUBMISSIONS / "quick_spiral.py").read_text(encoding="utf-8")
#: A class: student -> program.
CLASS = {
    "ada": (ROOT / "turtlesim_challenge" / "turtle_controller.py").read_text(encoding="utf-8"),
    "ben": QUICK,
    "dan": QUICK.replace("< 0.9:", "< 0.9 and pose.x > C:"),
    "eva": (MISTAKES / "hears_capital_pose.py").read_text(encoding="utf-8"),
    "gul": (MISTAKES / "raises_at_six.py").read_text(encoding="utf-8"),
}
ROBOT = ROOT / "grader_robots" / "exercises" / "description_package" / "reference"
#: Runs of the original turtlesim in tests/golden that are drawn again.
DRAWN = ("spiral", "pen_star")
#: How wide and high a photograph is [px].
SIZE = {"width": 1280, "height": 1000}


def api_of(package: str) -> str:
    """Return the part of the API's page about a package: what is public, and modules that are."""
    face = import_module(package)
    objects = (getattr(face, name) for name in face.__all__)
    names = (
        each.__name__ if ismodule(each) else f"{each.__module__}.{each.__qualname__}"
        for each in objects
        if callable(each) or ismodule(each)
    )
    ours = (name for name in names if name.startswith("grader."))
    return f"\n## {package}\n" + "".join(f"\n::: {name}\n" for name in ours)


def main() -> None:
    """Build, and tell what is wrong with what was built."""
    shutil.rmtree(OUT, ignore_errors=True)
    pages = OUT / "pages"
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    link = project.get("urls", {}).get("Repository")
    for path in [*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")]:
        text = for_python_markdown(path.read_text("utf-8"))
        place = "index.md" if path.name == "README.md" else path.relative_to(ROOT)
        write(pages / place, with_links(path, text, f"{link}/blob/main" if link else ""))
    for path in (ROOT / "docs").glob("*.png"):
        shutil.copy(path, pages / "docs")
    names = list(project["entry-points"]["grader.exercises"])
    write_sheets(pages / "exercises", names)
    write(pages / "api.md", API + "".join(map(api_of, FACES)))
    write_gallery(pages / "gallery")
    shutil.copytree(HERE, pages / "assets", ignore=shutil.ignore_patterns("*.py", "*.toml", "__*"))
    settings: dict[str, Any] = tomllib.loads((HERE / "zensical.toml").read_text("utf-8"))["project"]
    settings |= {"docs_dir": "pages", "site_dir": "html"}
    settings["plugins"]["mkdocstrings"]["handlers"]["python"]["paths"] = [str(ROOT)]
    (sheets,) = (entry["Exercises"] for entry in settings["nav"] if "Exercises" in entry)
    sheets += [f"exercises/{name}.md" for name in names]
    write(OUT / "mkdocs.yml", json.dumps(settings))
    build = [sys.executable, "-m", "zensical", "build", "--strict", "-f", str(OUT / "mkdocs.yml")]
    built = subprocess.run(build, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    told = COLOURS.sub("", built.stdout).partition("Traceback")[0]
    if built.returncode or "griffe:" in told:
        sys.exit(told)
    print(f"== the site is {(OUT / 'html').relative_to(ROOT)}/index.html")


def write(path: Path, text: str) -> None:
    """Write a page, in a folder that need not be there."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")


def with_links(path: Path, text: str, files: str) -> str:
    """Return a page whose links to files lead to the repository, or are but text without one."""

    def led(found: re.Match[str]) -> str:
        target = (path.parent / found[2]).resolve()
        if target == ROOT / "README.md":
            return f"[{found[1]}]({'../' * (path.parent != ROOT)}index.md{found[3] or ''})"
        if target.suffix in (".md", ".png") and target.parent in (ROOT, ROOT / "docs"):
            return found[0]
        return f"[{found[1]}]({files}/{target.relative_to(ROOT)})" if files else found[1]

    return LINK.sub(led, text)


def for_python_markdown(text: str) -> str:
    """Return a text with the same lists for Python-Markdown, which Zensical has, as for GitHub.

    There what belongs to a list item is indented by four, and an empty line precedes a list, and
    each item of one whose items have several paragraphs.
    """
    lines = text.split("\n")
    further, preceded = [0] * len(lines), set[int]()
    tokens = MarkdownIt("gfm-like", {"linkify": False}).parse(text)
    for token, within in pairwise(tokens):
        if token.map is None:
            continue
        first, end = token.map
        if token.type == "list_item_open" and (marker := MARKER.match(lines[first])):
            for number in range(first + 1, end):
                further[number] += max(0, 4 - len(marker[1]))
            if within.type == "paragraph_open" and not within.hidden:
                preceded.add(first)
        elif token.type.endswith("list_open") and token.level == 0:
            preceded.add(first)
    return "\n".join(
        "\n" * (number in preceded and number > 0 and lines[number - 1] != "")
        + (" " * further[number] + line if line else "")
        for number, line in enumerate(lines)
    )


def write_sheets(folder: Path, names: Iterable[str]) -> None:
    """Write the sheet of each exercise as students get it, and a page that lists them."""
    rows = []
    for name in names:
        exercise = load_exercise(name)
        write(folder / f"{name}.md", _sheet(name))
        worth = points(exercise.max_score)
        rows.append(f"| [{exercise.title!s}]({name}.md) | `{name}` | {worth} |\n")
    write(folder / "index.md", EXERCISES + "".join(rows))


def _sheet(name: str) -> str:
    told = io.StringIO()
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        with contextlib.redirect_stdout(told), contextlib.redirect_stderr(told):
            code = cli.main(["new", "my_solution", "--exercise", name, "--lang", "en"])
        if code:
            raise SystemExit(f"grader new --exercise {name}: {told.getvalue()}")
        return Path("my_solution", "README.md").read_text(encoding="utf-8")


class Gallery:
    """The folder of the gallery, and a browser that photographs pages in it."""

    def __init__(self, folder: Path, work: Path, browser: Any) -> None:
        self.folder, self.work = folder, work
        self._page = browser.new_page(viewport=SIZE, locale="en-US")

    def grader(self, *words: str | Path) -> None:
        subprocess.run(
            [sys.executable, "-m", "grader", *words, "--lang", "en"],
            cwd=self.work,
            env={**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])},
            stdout=subprocess.DEVNULL,
            check=True,
        )

    def picture(self, page: str, name: str, what: str) -> str:
        """Copy a page of the working folder, and photograph it; return that as a link to it."""
        (self.folder / page).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(self.work / page, self.folder / page)
        self._page.goto((self.folder / page).as_uri())
        self._page.wait_for_timeout(500)  # [ms] until plots are drawn
        self._page.screenshot(path=self.folder / f"{name}.png")
        return f"[![{what}]({name}.png)]({page})"


def write_gallery(folder: Path) -> None:
    """Write the page of the gallery, its pictures, and the pages that it leads to."""
    if not BROWSER:
        raise SystemExit("the gallery's pictures need Chromium, which `make needs` installs")
    folder.mkdir()
    with tempfile.TemporaryDirectory() as work, open_browser() as browser:
        text = "\n\n".join(_parts(Gallery(folder, Path(work), browser)))
    (folder / "index.md").write_text(f"{text}\n", encoding="utf-8")


def _parts(gallery: Gallery) -> Iterator[str]:
    for student, program in CLASS.items():
        path = gallery.work / "hand_ins" / f"{student}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(program, encoding="utf-8")
    yield "# Gallery\n\nThese pages were made together with this site, by the commands beside them."
    yield "## What a student sees\n\n    grader run dan.py"
    gallery.grader("run", "hand_ins/dan.py", "--out", "graded")
    yield gallery.picture("graded/report.html", "report", "The report: cause, picture, verdicts")
    yield "    grader view graded"
    gallery.grader("view", "graded", "--no-open")
    yield gallery.picture("graded/view.html", "view", "The player: window, curves, commands")
    yield "    grader run my_robot --exercise description_package"
    gallery.grader("run", ROBOT, "--exercise", "description_package", "--out", "robot")
    yield gallery.picture("robot/report.html", "robot", "A package that describes a robot")
    yield "## What a teacher sees\n\n    grader batch hand_ins --out class"
    gallery.grader("batch", "hand_ins", "--out", "class")
    yield gallery.picture("class/index.html", "class", "The class: scores, and how each check went")
    below = gallery.work / "class"
    for file in (*below.glob("submissions/*/report.html"), below / "gradebook.csv"):  # its links
        there = gallery.folder / file.relative_to(gallery.work)
        there.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(file, there)
    yield "## What the simulator draws\n\n    python -m turtlesim_py.scenario spiral.json --out ."
    for name in DRAWN:
        run = scenario.read(ROOT / "tests" / "golden" / f"{name}.json")
        scenario.write(scenario.replay(run), gallery.folder)
        yield f"![{name}]({name}.png)"


if __name__ == "__main__":
    main()
