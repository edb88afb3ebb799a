"""A solid as a browser draws it, on a telephone and on a desk.

A program in the page plays its reader: it asks for keys, clicks and moments as a person would, and
tells what came of it.
"""

from pathlib import Path

import pytest

from grader_robots.scene.driving import drive
from tests.browser import clipped, needs_browser
from tests.grader.reports.samples import verdict
from tests.grader_robots.reports.test_parts import package_trace, page_of
from tests.grader_robots.scene.robots import walks
from tests.grader_robots.scene.test_view import URDF

pytestmark = needs_browser

READER = Path(__file__).with_name("reader.js").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def robot(tmp_path_factory):
    return page_of(tmp_path_factory.mktemp("robot"), drive(walks, 400, URDF), "robot", verdict("a"))


def read(browser, folder, page: str, width: int) -> dict:
    """What the reader has seen."""
    path = folder / "page.html"
    path.write_text(page)
    opened = browser.new_page(viewport={"width": width, "height": 900})
    opened.goto(path.as_uri())
    said = opened.evaluate(READER) | {"clipped": clipped(opened)}
    opened.close()
    return said


@pytest.mark.parametrize("width", [375, 1280])
def test_the_robot_is_turned_by_keys_by_dragging_by_buttons_and_moved_by_time(
    browser, robot, width, tmp_path
):
    said = read(browser, tmp_path, robot, width)
    assert said["wide"] <= 0 and said["width"] == width
    assert (said["hidden"], said["clipped"]) == ([True, False], {})
    first = said["first"]
    assert first["blue"] > 100 and first["red"] > 30
    views = [said[name]["sum"] for name in ("first", "key", "drag", "nearer", "earlier")]
    assert len(set(views)) == len(views)
    assert said["nearer"]["blue"] > said["drag"]["blue"]
    assert said["back"] == first


def test_a_package_s_robot_stands_still_and_can_be_turned(browser, tmp_path):
    page = page_of(tmp_path, package_trace(), "package", verdict("a"))
    said = read(browser, tmp_path, page, 375)
    assert (said["wide"] <= 0, said["clipped"]) == (True, {})
    assert said["first"]["red"] > 2000
    assert said["key"]["sum"] != said["first"]["sum"] == said["back"]["sum"]
