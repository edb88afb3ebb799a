"""A solid as a browser draws it, on a telephone and on a desk.

A program in the page plays its reader: it asks for keys, clicks and moments as a person would, and
tells what came of it.
"""

from __future__ import annotations

import pytest

from grader_robots.scene.driving import drive
from tests.browser import clipped, needs_browser, open_browser
from tests.grader.reports.samples import verdict
from tests.grader_robots.reports.test_parts import package_trace, page_of
from tests.grader_robots.scene.robots import walks
from tests.grader_robots.scene.test_view import URDF

pytestmark = [needs_browser, pytest.mark.more("a browser; what it is given is tested as data")]

READER = """
async () => {
  const canvas = document.querySelector("canvas"), paper = canvas.getContext("2d");
  const frame = () => new Promise((done) => requestAnimationFrame(done));
  const look = async () => {
    await frame();
    await frame();
    const all = paper.getImageData(0, 0, canvas.width, canvas.height).data;
    let sum = 0, blue = 0, red = 0;
    for (let k = 0; k < all.length; k += 4 * 3) {
      sum = (sum * 31 + all[k] + 3 * all[k + 1] + 7 * all[k + 2]) % 1000003;
      blue += all[k + 2] > 90 && all[k] < 40 && all[k + 1] < 40;
      red += all[k] > 90 && all[k + 1] < 40 && all[k + 2] < 40;
    }
    return { sum, blue, red };
  };
  const key = (name) => canvas.dispatchEvent(new KeyboardEvent("keydown", { key: name }));
  const drag = (x) => {
    const at = canvas.getBoundingClientRect();
    const steps = [["pointerdown", 0, 1], ["pointermove", x, 1], ["pointerup", x, 0]];
    for (const [kind, across, buttons] of steps) {
      canvas.dispatchEvent(new PointerEvent(kind, {
        pointerId: 1, clientX: at.left + 50 + across, clientY: at.top + 50, buttons,
      }));
    }
  };
  canvas.setPointerCapture = () => {};
  const said = { wide: document.documentElement.scrollWidth - innerWidth, width: innerWidth };
  said.hidden = [...document.querySelectorAll(".still, .turning")].map((part) => part.hidden);
  said.first = await look();
  key("ArrowLeft");
  said.key = await look();
  drag(120);
  said.drag = await look();
  document.querySelector("[data-turn=nearer]").click();
  said.nearer = await look();
  document.querySelector("[data-turn=back]").click();
  said.back = await look();
  const slider = document.querySelector(".player input");
  if (slider) {
    slider.value = 1;
    slider.dispatchEvent(new Event("input"));
    await new Promise((done) => setTimeout(done, 0));
    said.earlier = await look();
  }
  return said;
}
"""


@pytest.fixture(scope="module")
def browser():
    with open_browser() as opened:
        yield opened


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
