"""Builds the site: `make docs`.

In build/site, `pages/` has the repository's pages, the sheets of the exercises, the API and the
gallery; `html/` is the site that Zensical makes of them, which checks every link.
"""

from __future__ import annotations

import contextlib
import io
import json
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterable
from itertools import pairwise
from pathlib import Path
from typing import Any

from markdown_it import MarkdownIt

import grader
from grader import cli, testing
from grader.exercise.loading import load_exercise
from grader.text import points
from scripts.site import gallery

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
    public = [f"{of.__name__}.{name}" for of in (grader, testing) for name in of.__all__]
    write(pages / "api.md", API + "".join(f"\n::: {name}\n" for name in public))
    gallery.write(pages / "gallery")
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


if __name__ == "__main__":
    main()
