"""Makes the gallery: runs are graded, and the pages that come of it are photographed."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.browser import BROWSER, open_browser
from tests.submissions import beginners
from turtlesim_py import scenario

ROOT = Path(__file__).resolve().parents[2]
QUICK = (ROOT / "tests" / "submissions" / "quick_spiral.py").read_text(encoding="utf-8")
#: A class: student -> program.
CLASS = {
    "ada": (ROOT / "turtlesim_challenge" / "turtle_controller.py").read_text(encoding="utf-8"),
    "ben": QUICK,
    "dan": QUICK.replace("< 0.9:", "< 0.9 and pose.x > C:"),
    "eva": beginners.changed("hears_capital_pose"),
    "gul": beginners.changed("raises_at_six"),
}
ROBOT = ROOT / "grader_robots" / "exercises" / "description_package" / "reference"
#: Runs of the original turtlesim in tests/golden that are drawn again.
DRAWN = ("spiral", "pen_star")
#: How wide and high a photograph is [px].
SIZE = {"width": 1280, "height": 1000}


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


def write(folder: Path) -> None:
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
    for file in (gallery.work / "class").glob("submissions/*/report.html"):  # which it leads to
        there = gallery.folder / file.relative_to(gallery.work)
        there.parent.mkdir(parents=True)
        shutil.copy(file, there)
    yield "## What the simulator draws\n\n    python -m turtlesim_py.scenario spiral.json --out ."
    for name in DRAWN:
        run = scenario.read(ROOT / "tests" / "golden" / f"{name}.json")
        scenario.write(scenario.replay(run), gallery.folder)
        yield f"![{name}]({name}.png)"
