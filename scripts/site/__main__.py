"""Builds the site: `make docs`.

    python -m scripts.site [--no-gallery]

In build/site, `pages/` is what scripts/site/ lays out (the repository's pages, the sheets of the
exercises, the API, the gallery), and `html/` is the site that Zensical makes of it, checked.
"""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from PIL import Image

from scripts.site import api, check, exercises, gallery, pages
from turtlesim_py.world import picture

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
OUT = ROOT / "build" / "site"
#: What colours a terminal: Zensical does so letter by letter, and everywhere.
COLOURS = re.compile(r"\x1b\[[0-9;]*m")
#: The empty corner of a table: it is no heading of anything.
CORNER = re.compile(r"<th( [^>]*)?></th>")
#: Four times the size at which it is shown [px].
LOGO_PX = 96


def main() -> None:
    """Build, and tell what is wrong with what was built."""
    shutil.rmtree(OUT, ignore_errors=True)
    laid_out, html = OUT / "pages", OUT / "html"
    laid_out.mkdir(parents=True)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    pages.lay_out(ROOT, laid_out)
    exercises.lay_out(laid_out / "exercises", project["entry-points"]["grader.exercises"])
    api.lay_out(laid_out / "api")
    (laid_out / "assets").mkdir()
    for name in ("site.css", "site.js"):
        shutil.copy(HERE / name, laid_out / "assets")
    turtle = Image.fromarray(picture.sprite("jazzy")).resize(
        (LOGO_PX, LOGO_PX), Image.Resampling.NEAREST
    )
    turtle.save(laid_out / "assets" / "turtle.png")
    if "--no-gallery" not in sys.argv:
        gallery.lay_out(laid_out / "gallery")
    settings = configuration(laid_out, project.get("urls", {}))
    (OUT / "mkdocs.yml").write_text(json.dumps(settings, indent=1), encoding="utf-8")
    build = [sys.executable, "-m", "zensical", "build", "--strict", "-f", str(OUT / "mkdocs.yml")]
    made = subprocess.run(build, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    told = COLOURS.sub("", made.stdout).partition("Traceback")[0]
    if made.returncode or "griffe:" in told:
        sys.exit(told)
    for page in html.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        page.write_text(CORNER.sub(r"<td\1></td>", text), encoding="utf-8")
    if problems := check.problems(laid_out, html, settings.get("site_url", "/")):
        sys.exit("\n".join([*problems, f"The site has {len(problems)} faults."]))
    print(f"== the site is {html.relative_to(ROOT)}/index.html")


def configuration(laid_out: Path, urls: dict[str, str]) -> dict[str, Any]:
    """Return the settings of the site, with the navigation spelled out."""
    text = (HERE / "zensical.toml").read_text("utf-8")
    settings: dict[str, Any] = tomllib.loads(text)["project"]
    settings |= {"docs_dir": laid_out.name, "site_dir": "html"}
    settings["nav"] = navigation(settings["nav"], laid_out)
    settings["plugins"]["mkdocstrings"]["handlers"]["python"]["paths"] = [str(ROOT)]
    if "Documentation" in urls:
        settings["site_url"] = urls["Documentation"]
    if link := urls.get("Repository"):  # not as `repo_url`: pages would ask GitHub for its stars
        social = {"icon": "lucide/folder-git-2", "name": "Repository", "link": link}
        settings["extra"] = {"social": [social]}
    return settings


def navigation(nav: list[Any], laid_out: Path) -> list[Any]:
    """Return a navigation with each pattern replaced by the pages that stand nowhere else.

    They come in the order in which the folder's own page lists them.
    """
    placed = {page for page in _leaves(nav) if "*" not in page}

    def spelled_out(entry: Any) -> Iterator[Any]:
        if isinstance(entry, dict):
            ((title, below),) = entry.items()
            if isinstance(below, list):
                below = [each for part in below for each in spelled_out(part)]
            if below:
                yield {title: below}
        elif "*" in entry:
            order = laid_out / entry.rpartition("/")[0] / "index.md"
            listed = order.read_text("utf-8") if order.exists() else ""
            names = {
                page.relative_to(laid_out).as_posix()
                for page in laid_out.glob(entry)
                if not page.read_text("utf-8").startswith(pages.NOT_SEARCHED)
            }
            new = sorted(
                names - placed, key=lambda name: (listed.find(f"({Path(name).name})"), name)
            )
            placed.update(new)
            yield from new
        else:
            yield entry

    return [each for entry in nav for each in spelled_out(entry)]


def _leaves(nav: Any) -> Iterator[str]:
    if isinstance(nav, str):
        yield nav
    else:
        for part in nav.values() if isinstance(nav, dict) else nav:
            yield from _leaves(part)


if __name__ == "__main__":
    main()
