import base64
import re
from io import BytesIO
from pathlib import Path

import numpy as np
import PIL.Image
import pytest
from playwright.sync_api import expect
from std_srvs.srv import Trigger

from tests.barriers import barriers
from tests.browser import (
    WIDTHS,
    clipped,
    cut_off,
    moving,
    needs_browser,
    obstacles,
)
from tests.programs import DEADLINE_S, Program
from tests.turtlesim_py.live.conftest import Page
from turtlesim_py.world import picture
from turtlesim_py.world.canvas import Canvas, Pen
from turtlesim_py.world.turtle import Sprite

pytestmark = needs_browser

#: The pixels of a canvas as text: a list of a million numbers takes seconds on its way here.
PIXELS = """
(canvas = document.getElementById("canvas")) => {
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let text = "";
  for (let i = 0; i < data.length; i += 8192) {
    text += String.fromCharCode(...data.subarray(i, i + 8192));
  }
  return btoa(text);
}
"""


class Person:
    """Somebody with the page in front of him; whatever fails in it fails the test."""

    def __init__(self, browser, address, **settings):
        settings = {"viewport": {"width": 1280, "height": 900}, "locale": "en-US"} | settings
        self.page = browser.new_page(**settings)
        self.page.set_default_timeout(DEADLINE_S * 1000)
        self.errors = []
        self.page.on("pageerror", lambda error: self.errors.append(str(error)))
        self.page.goto(address)
        self.is_connected()

    def is_connected(self):
        self.page.wait_for_selector("html[data-state=live]")

    def sees(self, text):
        self.page.get_by_text(text).first.wait_for()

    def sees_called(self, text):
        """The newest of what was just called; the table is of the same moment."""
        self.page.locator("#calls li:first-child", has_text=text).wait_for()

    def fill(self, form, **values):
        for name, value in values.items():
            self.page.fill(f"[data-form={form}] [name={name}]", value)
        self.page.click(f"[data-form={form}] button")

    def rests(self, zero="0.000"):
        """Wait until no turtle of the table moves."""
        still = f"tr:has(td:nth-child(5):text-is('{zero}')):has(td:nth-child(6):text-is('{zero}'))"
        rows = self.page.locator("#turtles tr")
        expect(self.page.locator(f"#turtles {still}")).to_have_count(
            rows.count(), timeout=DEADLINE_S * 1000
        )

    def canvas(self):
        pixels = pixels_of(self.page.evaluate(f"({PIXELS})()"))
        assert (pixels[..., 3] == 255).all()
        return pixels[..., :3]

    def leave(self):
        self.page.close()
        assert self.errors == []


def pixels_of(told):
    return np.frombuffer(base64.b64decode(told), np.uint8).reshape(500, 500, 4)


def until_equal(person, expected):
    """What has been drawn last arrives within some pictures of the screen."""
    for _ in range(200):
        if np.array_equal(person.canvas(), expected):
            return
        person.page.wait_for_timeout(50)
    differs = (person.canvas() != expected).any(axis=2)
    raise AssertionError(f"{differs.sum()} pixels differ, the first at {np.argwhere(differs)[0]}")


def test_a_person_draws_with_the_keys_and_it_is_the_picture_that_is_saved(browser, graph, tmp_path):
    words = ("view_port:=0", f"canvas_folder:={tmp_path}")
    arguments = ["-r", "__ns:=/drawn", *(word for each in words for word in ("-p", each))]

    def saved():
        answer = graph.call(Trigger, "/drawn/turtlesim/save_canvas")
        with PIL.Image.open(Path(answer.message)) as opened:
            return np.asarray(opened.convert("RGB"))

    with Program("turtlesim_py.ros.node", "--ros-args", *arguments, cwd=tmp_path) as program:
        page = Page(program)
        person, other = Person(browser, page.address), Person(browser, page.address)
        person.page.focus("#pad")
        for heading in "gt":
            person.page.keyboard.press(heading)
            person.sees_called("Rotation goal completed successfully")
            person.page.keyboard.press("ArrowUp")
            person.sees_called("ahead 2.000 m/s")
            person.rests()
        # who wants another one does not wait for the last
        for heading, theta in {"r": "1.571", "d": "3.142", "c": "-2.356", "v": "-1.571"}.items():
            person.page.keyboard.press(heading)
            person.sees(f"rotate_absolute of turtle1: to {theta} rad")
        person.page.keyboard.press("f")
        person.sees("rotate_absolute: cancelled")
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
        # how much depends on how busy the machine is: a late tick is not made up for
        assert (expected == (200, 10, 30)).all(axis=2).any()
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
    PIL.Image.fromarray(canvas.rgba()).save(png := BytesIO(), format="PNG")
    turtles = [
        Sprite(*places[n % len(places)], float(heading), name)
        for n, heading in enumerate(headings)
        for name in ("jazzy", "foxy")
    ]
    turtles += [Sprite(np.nan, 60.0, 1.0, "iron"), Sprite(60.0, 60.0, np.inf, "iron")]
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
    drawn = person.page.evaluate(
        """async ([png, runs, turtles]) => {
          const pixels = """
        + PIXELS
        + """;
          const { TurtleWindow } = await import("./window.js");
          const sprites = await (await fetch("sprites.json")).json();
          const canvas = document.createElement("canvas");
          const view = new TurtleWindow(canvas, sprites);
          await view.setPaint(png);
          view.setBackground([1, 2, 3]);
          view.draw([[[10, 200, 30], runs]]);
          view.turtles = turtles;
          view.show();
          return pixels(canvas);
        }""",
        [base64.b64encode(png.getvalue()).decode(), runs, told],
    )
    assert np.array_equal(pixels_of(drawn)[..., :3], expected)
    person.leave()


def told_number(value):
    return value if np.isfinite(value) else str(value)


def test_what_there_is_can_be_explored_and_nobody_is_kept_out(browser, page):
    person = Person(browser, page.address, reduced_motion="reduce")
    person.page.focus("#pad")
    person.page.keyboard.press("ArrowLeft")
    person.sees_called("turning 2.000 rad/s")
    assert moving(person.page) == 0
    explore(person)
    person.page.click("#services button:text-is('/seen/clear')")
    person.page.click("#detail button:text-is('Call')")
    expect(person.page.locator("#detail pre")).to_have_text("{}")
    assert barriers(person.page) == []
    person.leave()


def test_the_page_can_be_held_still_and_then_shows_what_there_is(browser, page):
    person, other = Person(browser, page.address), Person(browser, page.address)
    person.page.check("#hold")
    row = person.page.locator("#turtles tr").first
    shown = row.inner_text()
    person.page.focus("#pad")
    person.page.keyboard.press("ArrowRight")
    other.sees_called("turning -2.000 rad/s")
    other.rests()
    assert row.inner_text() == shown
    person.page.uncheck("#hold")
    expect(row).not_to_have_text(shown)
    person.sees_called("turning -2.000 rad/s")
    for each in (person, other):
        each.leave()


def explore(person):
    person.page.click("#refresh")
    person.page.click("#topics button:text-is('/seen/turtle1/pose')")
    person.sees("linear_velocity: float [m/s]")
    person.page.wait_for_selector("#detail pre:has-text('theta')")


@pytest.mark.parametrize("language", ("en", "fr", "zh"))
def test_nothing_is_wider_than_the_screen(browser, page, language):
    person = Person(browser, f"{page.address}?lang={language}")
    for box in ("#show-grid", "#show-quadrants", "#show-names"):
        person.page.check(box)
    explore(person)
    for width in WIDTHS:
        person.page.set_viewport_size({"width": width, "height": 512})
        assert person.page.evaluate("document.documentElement.scrollWidth") <= width
        assert cut_off(person.page) == []
    assert clipped(person.page) == {}
    person.leave()


SAID = {
    "fr": ("fr-FR", "avance 2,000 m/s", "0,000", "set_pen de turtle1"),
    "zh": ("zh-CN", "前进 2.000 m/s", "0.000", "turtle1 的 set_pen"),
}


@pytest.mark.parametrize("language", SAID)
def test_the_page_speaks_the_browsers_language(browser, page, language):
    locale, ahead, zero, pen = SAID[language]
    person = Person(browser, page.address, locale=locale)
    assert person.page.get_attribute("html", "lang") == language
    person.page.focus("#pad")
    person.page.keyboard.press("ArrowUp")
    person.sees_called(ahead)
    person.rests(zero)
    person.page.check("[data-form=set_pen] [name=off]")
    person.fill("set_pen")
    person.sees_called(pen)
    person.fill("teleport_relative")
    person.sees_called("teleport_relative")
    person.fill("teleport_absolute")
    person.fill("background")
    explore(person)
    assert obstacles(person.page) == []
    person.page.uncheck("[data-form=set_pen] [name=off]")
    person.fill("set_pen")
    person.leave()


def test_another_language_can_be_chosen_and_is_kept_for_the_session(browser, page):
    person = Person(browser, page.address, locale="de-DE")
    assert person.page.get_attribute("html", "lang") == "en"
    person.page.focus("#pad")
    person.page.keyboard.press("ArrowDown")
    person.sees_called("ahead -2.000 m/s")
    explore(person)
    person.page.fill("[data-form=spawn] [name=x]", "3.25")
    person.page.select_option("#language", "fr")
    person.sees_called("avance -2,000 m/s")
    quadrant = re.compile("en (haut|bas) à (droite|gauche)")
    person.page.locator("#turtles td", has_text=quadrant).first.wait_for()
    person.page.locator("#detail", has_text="publié par").wait_for()
    assert person.page.input_value("[data-form=spawn] [name=x]") == "3.25"
    assert "lang=fr" in person.page.url
    for address, language in ((page.address, "fr"), (f"{page.address}?lang=zh", "zh")):
        person.page.goto(address)
        person.is_connected()
        assert person.page.get_attribute("html", "lang") == language
        assert person.page.input_value("#language") == language
    person.leave()


def test_what_the_server_answers_is_said_in_the_pages_language(browser, page):
    person = Person(browser, page.address, locale="fr-CA")
    explore(person)
    person.page.fill("#detail textarea", '{"x": "loin"}')
    person.page.click("#detail button")
    person.sees("x\N{NO-BREAK SPACE}: nombre attendu, trouvé 'loin'")
    person.leave()


def test_what_a_catalogue_has_not_is_said_in_english(browser, page):
    context = browser.new_context(locale="zh-CN")
    context.route("**/zh.json", lambda route: route.fulfill(json={"Topics": "TOPICS"}))
    tab = context.new_page()
    tab.goto(page.address)
    tab.wait_for_selector("html[data-state=live][lang=zh]")
    assert tab.locator("#graph h3").all_inner_texts() == ["TOPICS", "Services"]
    context.route("**/zh.json", lambda route: route.abort())
    tab.reload()
    tab.wait_for_selector("html[data-state=live][lang=en]")
    assert tab.input_value("#language") == "en"
    context.close()
