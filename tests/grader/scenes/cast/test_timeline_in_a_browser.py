"""The timeline in a browser: for everybody, of much, looked back on while a run goes on."""

import base64
import re
from pathlib import Path

import numpy as np
import pytest

from grader.exercise.loading import load_exercise
from grader.scenes.cast import timeline
from grader.scenes.cast.timeline import TimelinePage, render
from grader.scenes.live import Grading
from grader.scenes.playback import JudgedCheck, Playback, PlayedRun
from tests import runs
from tests.barriers import barriers
from tests.browser import WIDTHS, clipped, cut_off, needs_browser
from tests.grader.exercise.expect.traces import endpoint, line, text, trace
from tests.programs import DEADLINE_S, Program

pytestmark = needs_browser

#: What the lanes show, RGBA in base64, and their width.
PIXELS = """
() => {
  const { width, height } = document.getElementById("lanes");
  const pen = document.getElementById("lanes").getContext("2d");
  const bytes = pen.getImageData(0, 0, width, height).data;
  let text = "";
  for (let i = 0; i < bytes.length; i += 8192) {
    text += String.fromCharCode(...bytes.subarray(i, i + 8192));
  }
  return [width, btoa(text)];
}
"""
ROWS, CURRENT = "#hops tr", "#hops tr[aria-current]"
HOSTILE = "<script>alert(1)</script> <b>"
#: Two messages a second for ten seconds, and a log line, from and to nodes with hostile names.
HOSTILE_RUN = trace(
    *(text(n / 2, "/chatter", f"{HOSTILE} {n}", node="/<b>one") for n in range(20)),
    line(9.9, HOSTILE),
    endpoint("topic /chatter", node="/<b>one"),
    endpoint("topic /chatter", node="/<b>other", writes=False),
)


@pytest.fixture(scope="module")
def everything():
    """A run with all that a cast has."""
    exercise = load_exercise(Path(__file__).parent / "everything")
    return runs.recordings("hostile_casts/does_all", exercise)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, everything):
    """The replay of that run, of the hostile one, and of one with much in it."""
    made = tmp_path_factory.mktemp("timeline")
    much = trace(*(text(n / 1000, "/chatter", str(n)) for n in range(10_000)))
    traces = (everything.nominal.trace, HOSTILE_RUN, much)
    played = tuple(PlayedRun(f"Run {n}", "finished", each) for n, each in enumerate(traces))
    moment = {"number": 1, "run": 1, "tick": 250, "x": None, "y": None, "text": HOSTILE}
    judged = (JudgedCheck("It says it", "failed", "failed", HOSTILE, "Say it.", (moment,)),)
    content = render(Playback(f"node.py {HOSTILE}", "", played, judged))
    (made / "replay.html").write_text(content, encoding="utf-8")
    return made


@pytest.fixture
def visit(browser):
    """Opens pages; whatever fails in one, or is fetched from elsewhere, fails the test."""
    pages, errors = [], list[str]()

    def visited(address, width=1200, **settings):
        page = browser.new_page(viewport={"width": width, "height": 900}, **settings)
        page.set_default_timeout(DEADLINE_S * 1000)
        pages.append(page)
        here = address.partition("?")[0]
        page.on("dialog", lambda dialog: errors.append(dialog.message))
        page.on("request", lambda a: a.url.startswith(("data:", here)) or errors.append(a.url))
        page.goto(address)
        return page

    yield visited
    for page in pages:
        page.close()
    assert errors == []


@pytest.fixture
def replay(folder, visit):
    return visit((folder / "replay.html").as_uri())


def columns(page):
    """The columns of the lanes in which there is a message from before the cursor [px]."""
    width, pixels = page.evaluate(PIXELS)
    shown = np.frombuffer(base64.b64decode(pixels), np.uint8).reshape(-1, width, 4)
    return np.flatnonzero((shown == (0x2B, 0x45, 0xC4, 255)).all(axis=2).any(axis=0)).tolist()


def cells(page, rows):
    found = page.locator(f"{rows} td").all_inner_texts()
    return found


def go(page, time_s):
    page.locator("#slider").fill(str(round(time_s / 0.016)))


def test_a_hop_is_seen_once_the_cursor_has_come_to_it(replay):
    replay.select_option("#about", "/chatter")
    go(replay, 0.5)
    assert columns(replay) == []
    go(replay, 3.5)
    wide = replay.locator("#lanes").bounding_box()["width"]
    seen = columns(replay)
    for second in (1, 2, 3):
        assert any(abs(column - second * wide / 5) < 0.05 * wide for column in seen)
    assert max(seen) < 3.5 * wide / 5
    assert cells(replay, CURRENT)[1:] == ["/node", "→ /peer", "/chatter", "Hello 2"]


def test_the_list_follows_the_cursor_and_the_page_stays_where_it_is(replay):
    replay.set_viewport_size({"width": 400, "height": 500})
    for time_s in (0.2, 1.0, 2.5, 4.9, 0.3):
        go(replay, time_s)
        assert float(cells(replay, CURRENT)[0].partition("–")[0]) <= time_s
        assert replay.evaluate("scrollY") == 0
        whole, row = (replay.locator(each).bounding_box() for each in (".list", CURRENT))
        assert whole["y"] <= row["y"] + 1
        assert row["y"] + row["height"] <= whole["y"] + whole["height"] + 1


def test_hostile_names_and_texts_are_text_and_their_moment_is_found(replay):
    replay.click("#checks button")
    assert "tick 250 of 625" in replay.inner_text("#time")
    who, whom, _, what = cells(replay, CURRENT)[1:]
    assert (who, whom, what) == ("/<b>one", "→ /<b>other", f"{HOSTILE} 8")
    assert replay.locator("b, script:not([type]):not(:last-of-type)").count() == 0


def test_ten_thousand_messages_can_be_used(folder, replay):
    replay.click("#runs button >> nth=2")
    go(replay, 8.0)
    assert cells(replay, CURRENT)[-1] == "8000"
    assert replay.locator(ROWS).count() < 100
    assert (folder / "replay.html").stat().st_size < 2_500_000


@pytest.mark.parametrize("width", WIDTHS)
def test_nobody_is_kept_from_using_the_replay(folder, visit, width):
    page = visit((folder / "replay.html").as_uri(), width, reduced_motion="reduce")
    for button in page.locator("#runs button").all()[:2]:
        button.click()
        go(page, 3.0)
        assert cut_off(page) == []
        assert page.evaluate("document.documentElement.scrollWidth") <= width
    assert barriers(page) == []
    assert clipped(page) == {}


@pytest.fixture
def live():
    served = TimelinePage.serve(0)
    yield served
    served.close()


def news(end_s, since_s=0.0):
    found = timeline.items(HOSTILE_RUN, round(since_s * 1e9))
    items = [each for each in found if each["t"] <= end_s]
    return {"t": end_s, "lanes": timeline.lanes(HOSTILE_RUN), "labels": {}, "items": items}


def test_who_looks_back_stays_there_while_it_grows(live, visit):
    live.hear([news(2.0)])
    page = visit(live.address)
    page.wait_for_selector("html[data-time='2']")
    assert cells(page, CURRENT)[-1] == f"{HOSTILE} 4"
    live.hear([news(3.0, 2.0), news(4.0, 3.0)])
    page.wait_for_selector("html[data-time='4']")
    assert cells(page, CURRENT)[-1] == f"{HOSTILE} 8"
    page.locator("#slider").focus()
    page.keyboard.press("Home")
    page.wait_for_selector(f"{CURRENT}:has-text('<b> 0')")
    live.hear([news(6.0, 4.0)])
    page.wait_for_selector("html[data-time='6']")
    assert cells(page, CURRENT)[-1] == f"{HOSTILE} 0"
    page.keyboard.press("End")
    page.wait_for_selector(f"{CURRENT}:has-text('<b> 12')")
    assert page.locator("main b, main script").count() == 0
    page.check("#hold")
    live.hear([news(7.0, 6.0)])
    visit(live.address).wait_for_selector("html[data-time='7']")
    assert page.get_attribute("html", "data-time") == "6"
    page.uncheck("#hold")
    page.wait_for_selector("html[data-time='7']")
    live.begin()
    page.wait_for_selector("html[data-time='0']")
    assert page.locator(ROWS).count() == 0


@pytest.mark.parametrize("width", [320, 1280])
def test_nobody_is_kept_from_looking_on(live, visit, width):
    live.hear([news(10.0)])
    live.update(Grading("node.py, talker", "nominal run", "Score: 1 of 2", "Do this first."))
    page = visit(live.address, width, locale="en-GB")
    page.wait_for_selector("html[data-time='10']")
    assert cut_off(page) == []
    assert barriers(page) == []
    assert clipped(page) == {}


def test_a_run_is_seen_to_its_end(tmp_path, visit):
    words = (str(runs.path_of("hostile_casts/does_all")), "--live", "--speed", "free")
    exercise = str(Path(__file__).with_name("everything"))
    given = ("run", *words, "--exercise", exercise, "--out", "out", "--lang", "en")
    with Program("grader", *given, cwd=tmp_path) as program:
        address = re.search(r"http://\S+", program.wait_for_line("See the runs at"))[0]
        page = visit(address)
        page.wait_for_selector("#state:has-text('The grading is over; what is here stays.')")
        assert program.wait() == 0
        page.select_option("#about", "/chatter")
        page.wait_for_selector(f"{CURRENT}:has-text('Hello 4')")
        assert page.inner_text("#grading-score") == "Score: 100 of 100"
