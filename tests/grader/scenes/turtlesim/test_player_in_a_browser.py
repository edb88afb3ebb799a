"""The page that plays runs in a real browser: to the pixel, by mouse, by keyboard alone."""

import base64

import numpy as np
import pytest

from grader.cli import main
from grader.recording import saving
from grader.recording.recording import Recordings
from grader.recording.subject import Start
from grader.scenes.turtlesim.trace import TurtleTrace
from grader.text.translations import ENGLISH, use
from tests.barriers import barriers
from tests.browser import WIDTHS, clipped, cut_off, moving, needs_browser, obstacles
from tests.grader.driving import RED, Spiral, drive, pen, twist
from tests.grader.reports import samples
from tests.grader.reports.samples import evidence, verdict

pytestmark = needs_browser

TICKS = 300
#: What the canvas shows, RGBA in base64.
PIXELS = """
(selector) => {
  const canvas = document.querySelector(selector);
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  let text = "";
  for (let i = 0; i < data.length; i += 8192) {
    text += String.fromCharCode(...data.subarray(i, i + 8192));
  }
  return btoa(text);
}
"""


class Wild:
    """Wide pens, a second turtle, and a clear: much that can be wrong when going back."""

    def __call__(self, tick, pose, arena):
        twist(arena, 3.0, 1.0 + tick / 100)
        if tick % 40 == 10:
            pen(arena, RED if tick % 80 == 10 else (tick % 256, 9, 200), 60)
        if tick == 100:
            arena.spawn(2.0, 3.0, 1.0, "turtle2")
        if tick == 150:
            arena.clear()
        if tick == 200:
            arena.kill("turtle2")


@pytest.fixture(scope="module")
def runs():
    return Recordings(drive(Wild(), ticks=TICKS), (drive(Spiral(), 120, Start(3.0, 7.0, 0.5)),))


@pytest.fixture(scope="module")
def page_file(tmp_path_factory, runs):
    folder = tmp_path_factory.mktemp("view")
    verdicts = [
        verdict("moves", evidence=[evidence("it starts", 0.16)]),
        verdict("stops", "failed", 0, evidence=[evidence("too far", 1.28, tick=80, run=1)]),
    ]
    samples.graded(folder / "graded", runs.nominal, *verdicts, varied=runs.varied)
    saving.save_all(Recordings(drive(Spiral(), ticks=200)), folder / "other")
    assert main(["view", str(folder / "graded"), "--no-open"]) == 0
    for language in ("en", "fr", "zh"):
        out = folder / "graded" / ("compared.html" if language == "en" else f"{language}.html")
        words = ["--compare", str(folder / "other"), "--out", str(out), "--lang", language]
        assert main(["view", str(folder / "graded"), "--no-open", *words]) == 0
    use(ENGLISH)
    return folder / "graded" / "view.html"


@pytest.fixture(scope="module")
def usual(browser):
    """What opens pages with nothing set: quicker than a new browser of each page's own."""
    context = browser.new_context(viewport={"width": 1280, "height": 900})
    context.new_page()  # as long as there is one, the process that draws stays
    return context


@pytest.fixture
def visit(browser, usual, page_file):
    """Opens the page; whatever fails in it fails the test."""
    pages, errors = [], []

    def visited(address="", name="view.html", **settings):
        page = browser.new_page(**settings) if settings else usual.new_page()
        pages.append(page)
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("console", lambda message: errors.append(message.text))
        page.on("request", lambda asked: asked.url.startswith("http") and errors.append(asked.url))
        page.goto(f"{page_file.with_name(name).as_uri()}{address}")
        page.wait_for_selector("html[data-frame]")
        return page

    yield visited
    for page in pages:
        page.close()
    assert errors == []


def at(page, frame, run=0):
    page.wait_for_selector(f"html[data-frame='{frame}'][data-run='{run}']")


def pixels(page, selector="#canvas"):
    data = np.frombuffer(base64.b64decode(page.evaluate(PIXELS, selector)), np.uint8)
    return data.reshape(500, 500, 4)[..., :3]


def go(page, frame):
    page.locator("#slider").fill(str(frame))
    at(page, frame)


def window(ticks):
    """What the simulator shows after so many ticks."""
    return TurtleTrace.of(drive(Wild(), ticks=ticks).trace).window


def test_every_moment_is_exact_in_whatever_order_they_are_looked_at(visit, runs):
    page = visit()
    at(page, TICKS)
    assert (pixels(page) == TurtleTrace.of(runs.nominal.trace).window).all()
    for frame in (0, TICKS, 149, 150, 3, 260, 199, 148, 200, 99, 100):
        go(page, frame)
        assert (pixels(page) == window(frame)).all(), frame
    page.click("#forth")
    at(page, 101)
    assert (pixels(page) == window(101)).all()
    page.click("#back")
    page.click("#back")
    at(page, 99)
    assert "1.584 s, tick 99 of 300" in page.inner_text("#time")


def test_all_runs_are_there_one_by_one_and_side_by_side(visit, runs):
    page = visit("#run=1&tick=120")
    at(page, 120, 1)
    assert (pixels(page) == TurtleTrace.of(runs.varied[0].trace).window).all()
    page.get_by_role("button", name="Side by side").click()
    at(page, 120, -1)
    page.locator("#slider").fill(str(TICKS))
    at(page, TICKS, -1)
    for number, run in enumerate(runs, 1):
        shown = pixels(page, f"#beside figure:nth-child({number}) canvas")
        assert (shown == TurtleTrace.of(run.trace).window).all()
    assert obstacles(page) == []


def test_it_plays_to_the_end_and_then_rests(visit):
    page = visit("#tick=280")
    page.select_option("#speed", "0.5")
    page.click("#play")
    assert "Pause" in page.inner_text("#play")
    at(page, TICKS)
    page.get_by_text("▶ Play").wait_for()


def test_evidence_leads_to_its_run_and_its_moment(visit):
    page = visit()
    page.get_by_role("button", name="too far").click()
    at(page, 80, 1)
    assert page.locator("#runs [aria-pressed=true]").inner_text() == "Varied run 1"
    assert page.locator("#ring circle").count() == 2
    page.click("#forth")
    at(page, 81, 1)
    assert page.locator("#ring circle").count() == 0


def test_the_call_at_the_cursor_is_marked_and_a_call_leads_to_its_tick(visit):
    page = visit("#tick=155")
    current = page.locator("#calls [aria-current]")
    assert "2.48 s" in current.inner_text()
    page.locator("#calls button", has_text="clear").first.click()
    at(page, 150)
    page.click("#call-after")
    at(page, 151)
    page.click("#call-before")
    at(page, 150)


def test_a_curve_can_be_dragged(visit):
    page = visit()
    box = page.locator("#plots svg").first.bounding_box()
    page.mouse.move(box["x"] + box["width"] * 0.9, box["y"] + 20)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] * 0.25, box["y"] + 20)
    at(page, TICKS // 4)
    page.mouse.up()


def test_all_of_it_goes_by_keyboard_alone(visit):
    page = visit()
    page.locator("#slider").focus()
    for key, frame in (("Home", 0), ("ArrowRight", 1), (".", 2), (",", 1), ("End", TICKS)):
        page.keyboard.press(key)
        at(page, frame)
    page.keyboard.press("Home")
    page.keyboard.press(" ")
    page.wait_for_selector("html:not([data-frame='0'])")
    page.keyboard.press(" ")
    assert "Play" in page.inner_text("#play")
    for _ in range(60):
        page.keyboard.press("Tab")
        if "too far" in page.evaluate("document.activeElement.textContent"):
            break
    page.keyboard.press("Enter")
    at(page, 80, 1)


def test_two_ways_lie_over_each_other_and_are_told_apart_by_more_than_colour(visit):
    page = visit("#tick=100", name="compared.html")
    at(page, 100)
    assert page.locator("#ways path.mine, #ways path.other").count() == 2
    dashes = "element => getComputedStyle(element).strokeDasharray"
    kinds = [page.locator(f"#ways .{name}").evaluate(dashes) for name in ("mine", "other")]
    assert kinds == ["none", "7px, 5px"]
    assert "The inputs differ first at 0.016 s, tick 1: here" in page.inner_text("#parts")
    assert page.locator("#plots figure").first.inner_text().startswith("apart: ")
    assert page.locator("#turtles tr").count() == 3
    page.uncheck("#show-ways")
    assert not page.locator("#ways").is_visible()
    page.get_by_role("button", name="Varied run 1", exact=True).click()
    page.get_by_text("The other recording has no such run.").wait_for()
    assert obstacles(page) == []


def test_nobody_is_kept_out_and_nothing_moves_by_itself_where_less_motion_is_asked_for(visit):
    page = visit("#tick=120", reduced_motion="reduce")
    assert barriers(page) == []
    page.get_by_role("button", name="too far").click()
    at(page, 80, 1)
    assert moving(page) == 0


def test_keys_that_a_reader_needs_elsewhere_move_nothing(visit):
    page = visit("#tick=120")
    for key in (" ", ".", ","):
        page.keyboard.press(key)
    page.locator("#calls button").first.focus()
    page.keyboard.press(".")
    assert "tick 120 of" in page.inner_text("#time")
    assert "Play" in page.inner_text("#play")


@pytest.mark.parametrize("name", ["view.html", "compared.html", "fr.html", "zh.html"])
def test_nothing_is_wider_than_the_screen(visit, name):
    page = visit("#tick=120", name=name)
    for width in WIDTHS:
        page.set_viewport_size({"width": width, "height": 512})
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        assert cut_off(page) == []
    assert clipped(page) == {}


def test_a_value_that_jumps_to_and_fro_does_not_fill_its_plot(visit):
    jumps, curve = visit().locator("#plots figure:nth-child(4) path").all()
    assert (jumps.get_attribute("class"), curve.get_attribute("class")) == ("curve jumps", "curve")
    faint, whole = (
        each.evaluate("it => getComputedStyle(it).strokeOpacity") for each in (jumps, curve)
    )
    assert "L" in jumps.get_attribute("d") and float(faint) < float(whole) == 1


def test_which_run_is_shown_is_seen_where_the_reader_chooses_the_colours(visit):
    page = visit("#tick=120", forced_colors="active")
    colour = "each => getComputedStyle(each).backgroundColor"
    shown, other = (
        page.locator(f"button[aria-pressed={is_it}]").first for is_it in ("true", "false")
    )
    assert shown.evaluate(colour) != other.evaluate(colour)


@pytest.mark.parametrize(
    ("language", "tick", "curve"),
    [
        ("fr", "1,920 s, pas 120 sur 300", "écart\N{NO-BREAK SPACE}: "),
        ("zh", "1.920 s\uff0c第 120 步\uff0c共 300 步", "相距\uff1a"),
    ],
)
def test_it_speaks_the_language_of_the_call_whatever_the_browsers(visit, language, tick, curve):
    page = visit("#tick=121", name=f"{language}.html", locale="en-US")
    page.click("#back")
    at(page, 120)
    assert page.get_attribute("html", "lang") == language
    assert page.inner_text("#time") == tick
    assert page.inner_text("#plots figcaption span >> nth=0").startswith(curve)
    assert obstacles(page) == []
