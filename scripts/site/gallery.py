"""Makes the gallery: what the simulator draws, what a student sees, and what a teacher sees.

Nothing of it is kept in the repository: runs of the original are replayed, solutions and mistakes
that the tests have are graded, and the pages that come of it are photographed in a browser.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.browser import BROWSER, open_browser
from tests.programs import Program
from tests.submissions import beginners
from turtlesim_py import scenario

ROOT = Path(__file__).resolve().parents[2]
GOLDEN = ROOT / "tests" / "golden"
#: Scripted runs of the original turtlesim in tests/golden -> what is seen in them.
DRAWN = {
    "spiral": "The spiral of the challenge",
    "pen_star": "Lines in 16 directions, with six widths of the pen",
    "pen_widths": "One wavy line for each width",
    "spawn_many": "Several turtles",
}
QUICK = (ROOT / "tests" / "submissions" / "quick_spiral.py").read_text(encoding="utf-8")
#: A class: student -> program.
CLASS = {
    "ada": (ROOT / "turtlesim_challenge" / "turtle_controller.py").read_text(encoding="utf-8"),
    "ben": QUICK,
    "chloe": QUICK.replace("(True, False): (0, 0, 0)", "(True, False): (0, 200, 200)"),
    "dan": QUICK.replace("< 0.9:", "< 0.9 and pose.x > C:"),
    "eva": beginners.changed("hears_capital_pose"),
    "finn": beginners.changed("int_linear"),
    "gul": beginners.changed("raises_at_six"),
}
#: Other exercises -> a right solution, what its page shows, and the part of the page that does.
OTHERS = {
    "talker_listener": (
        ROOT / "grader" / "exercises" / "talker_listener" / "reference",
        "Two nodes and a launch file: each message, hop by hop",
        "section.more",
    ),
    "description_package": (
        ROOT / "grader_robots" / "exercises" / "description_package" / "reference",
        "A package that describes a robot: nothing is started",
        "section.first",
    ),
}
#: How wide a photograph is, and how high at most [px].
WIDTH, HEIGHT = 1280, 1000
#: What the grader says of its work, where there is no terminal.
PROGRESS = re.compile(r"^(Found: .*|Running it .*)\n", re.MULTILINE)


class Gallery:
    """The folder of the gallery, and a browser that photographs pages in it."""

    def __init__(self, folder: Path, work: Path, browser: Any) -> None:
        self.folder, self.work = folder, work
        self._page = browser.new_page(viewport={"width": WIDTH, "height": HEIGHT}, locale="en-US")

    def grader(self, *words: str) -> str:
        """Call the grader; return what it prints."""
        done = subprocess.run(
            [sys.executable, "-m", "grader", *words, "--lang", "en"],
            cwd=self.work,
            env={**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])},
            capture_output=True,
            text=True,
        )
        if done.returncode:
            raise SystemExit(f"grader {' '.join(words)}:\n{done.stdout}{done.stderr}")
        return PROGRESS.sub("", done.stdout)

    def keep(self, file: Path, name: str) -> str:
        """Copy a page into the gallery; return its address there."""
        (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(file, self.folder / name)
        return name

    def photograph(self, address: str, name: str, what: str, at: str = "body") -> str:
        """Photograph a page of the gallery; return the picture as a link to it, in Markdown.

        Args:
            at: the part of the page with which the picture begins, as a selector.
        """
        self._page.goto((self.folder / address).as_uri())
        self._page.locator(at).first.evaluate("(part) => part.scrollIntoView()")
        return f"[{self._picture(name, what)}]({address})"

    def live(self) -> str:
        """Photograph the page of a simulator in which somebody has drawn; return the picture."""
        star = [("0.8", "7"), ("10.2", "7"), ("2.6", "0.9"), ("5.5", "10.4"), ("8.4", "0.9")]
        with Program("turtlesim_py.ros.node", "--ros-args", "-p", "view_port:=0") as program:
            address = program.wait_for_line("to be seen at").split()[-1]
            self._page.goto(address)
            self._page.wait_for_selector("html[data-state=live]")
            self._page.check("[data-form=set_pen] [name=off]")
            self._fill("set_pen")
            self._fill("teleport_absolute", x=star[0][0], y=star[0][1])
            self._page.uncheck("[data-form=set_pen] [name=off]")
            self._fill("set_pen", width="5")
            for x, y in [*star[1:], star[0]]:
                self._fill("teleport_absolute", x=x, y=y)
            self._fill("spawn", x="8", y="8.5", theta="3.9", name="friend")
            self._page.get_by_text("friend").first.wait_for()
            return self._picture("live", "The page of the simulator: window, forms, log")

    def _fill(self, form: str, **values: str) -> None:
        for name, value in values.items():
            self._page.fill(f"[data-form={form}] [name={name}]", value)
        self._page.click(f"[data-form={form}] button")

    def _picture(self, name: str, what: str) -> str:
        self._page.wait_for_timeout(500)  # [ms] until plots are drawn
        self._page.screenshot(path=self.folder / f"{name}.png")
        return f"![{what}]({name}.png)"


def lay_out(folder: Path) -> None:
    """Write the page of the gallery, its pictures, and the pages that it leads to."""
    if not BROWSER:
        raise SystemExit("the gallery's pictures need Chromium, which `make needs` installs")
    folder.mkdir()
    with tempfile.TemporaryDirectory() as work, open_browser() as browser:
        gallery = Gallery(folder, Path(work), browser)
        parts = [*_student(gallery), *_teacher(gallery), *_simulator(gallery)]
    text = "\n\n".join([INTRODUCTION, *parts])
    (folder / "index.md").write_text(f"{text}\n", encoding="utf-8")


INTRODUCTION = """# Gallery

These pictures, and the pages that they lead to, were made together with this site, by the commands
that stand with them. The pages are those that the grader writes: one file each, which needs no
network."""


def _student(gallery: Gallery) -> Iterator[str]:
    file, command = "turtle_controller.py", "grader run turtle_controller.py"
    (gallery.work / file).write_text(CLASS["dan"], encoding="utf-8")
    told = gallery.grader("run", file, "--out", "graded")
    gallery.grader("view", "graded", "--no-open")
    report = gallery.keep(gallery.work / "graded" / "report.html", "student/report.html")
    view = gallery.keep(gallery.work / "graded" / "view.html", "student/view.html")
    yield "## What a student sees"
    yield (
        "A node that draws the spiral, and stops only where it happens to come near a wall on the "
        "right. In the usual run that is enough; where the turtle starts elsewhere, it is not:"
    )
    yield f"    {command}"
    yield f"```text\n{told.strip()}\n```"
    yield "The page beside it has the picture, with a pin where it went wrong:"
    yield gallery.photograph(report, "report", "The report: cause, picture, verdicts")
    yield "`grader view` plays the run tick by tick, with the line of the node behind each command:"
    yield gallery.photograph(view, "view", "The player: window, curves, commands")
    for name, (solution, what, at) in OTHERS.items():
        gallery.grader("run", str(solution), "--exercise", name, "--out", name)
        page = gallery.keep(gallery.work / name / "report.html", f"{name}/report.html")
        yield f"### {what}"
        yield f"    grader run {solution.name} --exercise {name}"
        yield gallery.photograph(page, name, what, at)


def _teacher(gallery: Gallery) -> Iterator[str]:
    hand_ins = gallery.work / "hand_ins"
    hand_ins.mkdir()
    for student, program in CLASS.items():
        (hand_ins / f"{student}.py").write_text(program, encoding="utf-8")
    gallery.grader("batch", "hand_ins", "--out", "spring")
    spring = gallery.work / "spring"
    for pattern in ("*.html", "*.csv", "submissions/*/*.html"):
        for file in spring.glob(pattern):
            gallery.keep(file, f"class/{file.relative_to(spring)}")
    yield "## What a teacher sees"
    yield f"    grader batch submissions.zip --out spring    # a class of {len(CLASS)}"
    page = "class/index.html"
    yield gallery.photograph(page, "class", "The class: scores, and how each check went")
    yield "Further down it has everybody's drawing, and what to fix first:"
    yield gallery.photograph(page, "drawings", "The drawings of the class", ".beside.drawn")


def _simulator(gallery: Gallery) -> Iterator[str]:
    yield "## What the simulator draws"
    yield "Scripted runs that were recorded from the original, drawn again without any ROS:"
    yield "    python -m turtlesim_py.scenario tests/golden/spiral.json --out figures"
    yield '<div class="drawn" markdown>'
    for name, what in DRAWN.items():
        scenario.write(scenario.replay(scenario.read(GOLDEN / f"{name}.json")), gallery.work)
        gallery.keep(gallery.work / f"{name}.png", f"{name}.png")
        picture = f"![{what}]({name}.png)"
        yield f"<figure markdown>\n{picture}\n<figcaption>{what}</figcaption>\n</figure>"
    yield "</div>"
    yield "`turtlesim` opens a page to see and drive the turtles:"
    yield gallery.live()
