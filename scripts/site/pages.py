"""Lays the repository's own pages out for the site: the same folders, and links that lead inside.

A link to a file that is no page (a schema, a module, a folder of examples) leads to a page that
shows it. So the site needs no address of the repository, and shows the files of its own version.
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path, PurePosixPath

from markdown_it import MarkdownIt

#: Where a Markdown link leads: `](TARGET)`.
LINK = re.compile(r"(?<=\]\()([^()\s#]+)(#[^()\s]*)?(?=\))")
#: What is in no repository.
MADE = ("__pycache__", "*.py[co]")
#: Suffix -> how Pygments calls the language; others have their suffix's name.
LANGUAGES = {"py": "python", "js": "javascript", "yml": "yaml", "sh": "bash", "": "text"}
PICTURES = (".png", ".svg")
#: A page that shows a file is found by its links, not by the search.
NOT_SEARCHED = "---\nsearch:\n  exclude: true\n---\n\n"
HOME = "README.md"
_MARKER = re.compile(r" *((?:[-*+]|\d+[.)]) +)")
_PICTURE = re.compile(r"^<img .*>$", re.MULTILINE)
_DOORS = re.compile(r"^\*\*Three doors:\*\* (.*)$", re.MULTILINE)


def lay_out(root: Path, into: Path) -> None:
    """Write the pages of the repository, and of all files that they link to."""
    pages = [*root.glob("*.md"), *(root / "docs").rglob("*.md")]
    waiting, done = [page.relative_to(root) for page in sorted(pages)], set[Path]()
    while waiting:
        path = waiting.pop()
        if path in done:
            continue
        done.add(path)
        place = into / place_of(root, path)
        place.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix in PICTURES:
            shutil.copy(root / path, place)
            continue
        text = _text(root, path)
        linked: list[Path] = []
        place.write_text(with_links(root, path, text, linked.append), encoding="utf-8")
        waiting += linked
    for picture in (root / "docs").rglob("*.png"):  # some are named in HTML
        shutil.copy(picture, into / picture.relative_to(root))


def place_of(root: Path, path: Path) -> PurePosixPath:
    """Return where the site has a file or folder of the repository, from its own top."""
    pure = PurePosixPath(*(part.lstrip(".") for part in path.parts))  # what is hidden is no page
    if (root / path).is_dir():
        return pure / "files.md"
    if pure.name == HOME:
        return pure.with_name("index.md")
    if pure.suffix == ".md" or pure.suffix in PICTURES:
        return pure
    return pure.with_name(f"{pure.name}.md")


def with_links(root: Path, path: Path, text: str, linked: Callable[[Path], object]) -> str:
    """Return the text with links as the site needs them.

    Args:
        path: the file that it is from.
        linked: gets each file and folder of the repository that is linked.
    """
    above = place_of(root, path).parent
    folder = path if (root / path).is_dir() else path.parent

    def led(found: re.Match[str]) -> str:
        target = Path(os.path.normpath(folder / found[1]))
        if ":" in found[1] or target.is_absolute() or not (root / target).exists():
            return found[0]  # elsewhere; or nowhere, which the check of the site tells
        linked(target)
        return os.path.relpath(place_of(root, target), above) + (found[2] or "")

    return LINK.sub(led, text)


def _text(root: Path, path: Path) -> str:
    """Return the page of a file or folder, with links as from its own place."""
    whole = root / path
    if whole.is_dir():
        return _folder(whole, path)
    text = whole.read_text(encoding="utf-8")
    if path.suffix == ".md":
        text = for_python_markdown(text)
        return home(text) if path == Path(HOME) else text
    language = LANGUAGES.get(suffix := path.suffix.removeprefix("."), suffix)
    fence = "`" * max(3, *(len(ticks) + 1 for ticks in re.findall("`+", text + "`")))
    return f"{NOT_SEARCHED}# {path.name}\n\n`{path}`\n\n{fence}{language}\n{text}\n{fence}\n"


def _folder(whole: Path, path: Path) -> str:
    found = sorted(
        file.relative_to(whole)
        for file in whole.rglob("*")
        if file.is_file() and not any(part.match(made) for part in file.parents for made in MADE)
    )
    lines = [f"- [`{file}`]({file})" for file in found if not any(map(file.match, MADE))]
    return f"{NOT_SEARCHED}# {path.name}\n\n`{path}/`\n\n" + "\n".join(lines) + "\n"


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
        if token.type == "list_item_open" and (marker := _MARKER.match(lines[first])):
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


def home(readme: str) -> str:
    """Return the landing page: the README, with its picture beside its first words."""
    head, rest = readme.split("\n## ", 1)
    picture, doors = _PICTURE.search(head), _DOORS.search(head)
    if picture is None or doors is None:
        raise SystemExit(f"{HOME}: its head needs a line <img ...> and one **Three doors:** ...")
    words = head.replace(picture[0], "").replace(doors[0], "").strip()
    buttons = doors[1].replace(" · ", "\n").replace(")", "){ .md-button .md-button--primary }")
    parts = [
        "---\nhide:\n  - navigation\n  - toc\n---\n",
        '<div class="welcome" markdown>\n<div markdown>\n',
        f"{words}\n\n{buttons}\n{{ .doors }}\n",
        f"</div>\n\n{picture[0]}\n\n</div>\n",
        f"## {rest}",
    ]
    return "\n".join(parts)
