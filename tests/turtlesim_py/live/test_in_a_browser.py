"""The page in a real browser: what a person does there, and what he sees."""

from __future__ import annotations

import base64
from io import BytesIO
from pathlib import Path

import numpy as np
import PIL.Image
import pytest
from playwright.sync_api import expect
from std_srvs.srv import Trigger

from tests.browser import needs_browser, obstacles, open_browser
from tests.programs import DEADLINE_S, Program
from tests.turtlesim_py.live.conftest import Page
from turtlesim_py.world import picture
from turtlesim_py.world.canvas import Canvas, Pen

pytestmark = needs_browser

PIXELS = """
() => {
  const canvas = document.getElementById("canvas");
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let text = "";
  for (let i = 0; i < data.length; i += 8192) {
    text += String.fromCharCode(...data.subarray(i, i + 8192));
  }
  return btoa(text);
}
"""


@pytest.fixture(scope="module")
def browser():
    with open_browser() as opened:
        yield opened


class Person:
    """Somebody with the page in front of him; whatever fails in it fails the test."""

    def __init__(self, browser, address: str) -> None:
        self.page = browser.new_page(viewport={"width": 1280, "height": 900})
        self.page.set_default_timeout(DEADLINE_S * 1000)
        self.errors: list[str] = []
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.goto(address)
        self.is_connected()

    def is_connected(self) -> None:
        self.page.wait_for_selector("html[data-state=live]")

    def sees(self, text: str) -> None:
        self.page.get_by_text(text).first.wait_for()

    def sees_called(self, text: str) -> None:
        """The newest of what was just called; the table is of the same moment."""
        self.page.locator("#calls li:first-child", has_text=text).wait_for()

    def fill(self, form: str, **values: str) -> None:
        """Fill a form in and send it."""
        for name, value in values.items():
            self.page.fill(f"[data-form={form}] [name={name}]", value)
        self.page.click(f"[data-form={form}] button")

    def rests(self) -> None:
        """Wait until no turtle of the table moves."""
        still = "tr:has(td:nth-child(5):text-is('0.000')):has(td:nth-child(6):text-is('0.000'))"
        rows = self.page.locator("#turtles tr")
        expect(self.page.locator(f"#turtles {still}")).to_have_count(
            rows.count(), timeout=DEADLINE_S * 1000
        )

    def canvas(self) -> np.ndarray:
        """The pixels that are shown, RGB."""
        pixels = np.frombuffer(base64.b64decode(self.page.evaluate(PIXELS)), np.uint8)
        assert (pixels[3::4] == 255).all()
        return pixels.reshape(500, 500, 4)[..., :3]

    def leave(self) -> None:
        self.page.close()
        assert self.errors == []


def until_equal(person: Person, expected: np.ndarray) -> None:
    """What has been drawn last arrives within some pictures of the screen."""
    for _ in range(200):
        if np.array_equal(person.canvas(), expected):
            return
        person.page.wait_for_timeout(50)
    differs = (person.canvas() != expected).any(axis=2)
    raise AssertionError(f"{differs.sum()} pixels differ, the first at {np.argwhere(differs)[0]}")


def test_a_person_draws_a_square_with_the_keys_and_it_is_the_picture_that_is_saved(
    browser, graph, tmp_path
):
    words = ("view_port:=0", f"canvas_folder:={tmp_path}")
    arguments = ["-r", "__ns:=/drawn", *(word for each in words for word in ("-p", each))]

    def saved() -> np.ndarray:
        answer = graph.call(Trigger, "/drawn/turtlesim/save_canvas")
        with PIL.Image.open(Path(answer.message)) as opened:
            return np.asarray(opened.convert("RGB"))

    with Program("turtlesim_py.ros.node", "--ros-args", *arguments, cwd=tmp_path) as program:
        page = Page(program)
        person, other = Person(browser, page.address), Person(browser, page.address)
        for heading in "grdv":  # right, up, left, down
            person.page.focus("#pad")
            person.page.keyboard.press(heading)
            person.sees_called("Rotation goal completed successfully")
            person.page.keyboard.press("ArrowUp")
            person.sees_called("ahead 2.000 m/s")
            person.rests()
        person.page.fill("[data-form=set_pen] [name=color]", "#c80a1e")
        person.fill("set_pen", width="9")
        person.sees_called("set_pen of turtle1: 200, 10, 30; 9 px")
        person.page.click("[data-drive=left]")
        person.sees_called("turning 2.000 rad/s")
        person.rests()
        person.page.click("[data-drive=up]")
        person.sees_called("ahead 2.000 m/s")
        person.rests()
        person.fill("spawn", x="2", y="3", theta="1", name="second")
        person.sees_called("Spawning turtle [second]")
        expect(person.page.locator("#turtles tr")).to_have_count(2)
        person.page.fill("[data-form=background] [name=color]", "#102030")
        person.fill("background")
        person.sees("background: done")
        expected = saved()
        until_equal(person, expected)
        until_equal(other, expected)
        assert (expected == (200, 10, 30)).all(axis=2).sum() > 500
        assert program.stop() == 0
        person.page.wait_for_selector("html[data-state=lost]")
    again = [*arguments, "-p", f"view_port:={page.port}"]
    with Program("turtlesim_py.ros.node", "--ros-args", *again, cwd=tmp_path) as program:
        for each in (person, other):
            each.is_connected()
            expect(each.page.locator("#turtles tr")).to_have_count(1)
            until_equal(each, saved())
            each.leave()
        assert program.stop() == 0


def test_turtles_are_turned_and_laid_over_as_the_simulator_does(browser, page):
    """The page's own code on turtles of every heading, at the edge, and nowhere."""
    person = Person(browser, page.address)
    headings = [*np.linspace(-3.2, 3.2, 37), 0.0, np.pi / 2, 3.14159265, 1.5707963267948966]
    places = [(x, y) for x in (-10.0, 0.3, 250.0, 499.9) for y in (17.25, 480.5)]
    canvas = Canvas()
    canvas.draw_line(20.0, 30.0, 400.5, 310.25, Pen(10, 200, 30, 12))
    turtles = [
        picture.Sprite(*places[n % len(places)], float(heading), name)
        for n, heading in enumerate(headings)
        for name in ("jazzy", "foxy")
    ]
    turtles += [
        picture.Sprite(float("nan"), 60.0, 1.0, "iron"),
        picture.Sprite(60.0, 60.0, float("inf"), "iron"),
    ]
    runs = []
    canvas.watcher = lambda pen, spans: runs.extend(n for span in spans for n in span)
    canvas.draw_line(90.0, 400.0, 80.0, 20.0, Pen(10, 200, 30, 12))
    expected = picture.render(canvas, (1, 2, 3), turtles)
    told = [
        {
            "name": str(number),
            "sprite": turtle.name,
            "px": [told_number(turtle.x_px), told_number(turtle.y_px)],
            "heading": told_number(turtle.heading_rad),
        }
        for number, turtle in enumerate(turtles)
    ]
    first = Canvas()
    first.draw_line(20.0, 30.0, 400.5, 310.25, Pen(10, 200, 30, 12))
    drawn = person.page.evaluate(
        """async ([png, runs, turtles]) => {
          const { TurtleWindow } = await import("./window.js");
          const sprites = await (await fetch("sprites.json")).json();
          const canvas = document.createElement("canvas");
          const view = new TurtleWindow(canvas, sprites);
          await view.setPaint(png);
          view.setBackground([1, 2, 3]);
          view.draw([[[10, 200, 30], runs]]);
          view.turtles = turtles;
          view.show();
          const { data } = canvas.getContext("2d").getImageData(0, 0, 500, 500);
          return [...data];
        }""",
        [png_of(first), runs, told],
    )
    shown = np.array(drawn, np.uint8).reshape(500, 500, 4)[..., :3]
    assert np.array_equal(shown, expected)
    person.leave()


def told_number(value: float) -> float | str:
    return value if np.isfinite(value) else str(value)


def png_of(canvas: Canvas) -> str:
    file = BytesIO()
    PIL.Image.fromarray(canvas.rgba()).save(file, format="PNG")
    return base64.b64encode(file.getvalue()).decode()


@pytest.mark.parametrize("width", [375, 1280])
def test_nothing_is_wider_than_the_screen_and_what_there_is_can_be_explored(browser, page, width):
    person = Person(browser, page.address)
    person.page.set_viewport_size({"width": width, "height": 800})
    person.page.click("#refresh")
    person.page.click("#topics button:text-is('/seen/turtle1/pose')")
    person.sees("linear_velocity: float [m/s]")
    person.page.wait_for_selector("#detail pre:has-text('theta')")
    person.page.click("#services button:text-is('/seen/clear')")
    person.page.click("#detail button:text-is('Call')")
    expect(person.page.locator("#detail pre")).to_have_text("{}")
    assert person.page.evaluate("document.documentElement.scrollWidth") <= width
    assert obstacles(person.page) == []
    person.leave()
