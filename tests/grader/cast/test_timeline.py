"""What was exchanged, hop by hop: as data, in the page that plays it, and live."""

from __future__ import annotations

import pytest

import grader
from grader.cast import timeline
from grader.cast.pages import TimelinePage
from grader.cast.trace import ROSOUT, CastTrace
from grader.recording.recording import Recording, Recordings
from grader.reports import playback
from grader.scenes import load_scene
from grader.scenes.live import Grading
from tests import runs
from tests.browser import needs_browser, open_browser
from tests.grader.exercise.expect.traces import endpoint, line, text, trace

FOLDER = runs.SUBMISSIONS / "tutorials"
HOSTILE = "</script><img src=x onerror=alert(1)> \u202e\x1b[2J"


@pytest.fixture(scope="module")
def recorded():
    """The runs of right solutions, by their exercises."""
    names = ("talker", "action_server", "service_client")
    return {n: grader.record(FOLDER / n / "right" / "official.py", n) for n in names}


def items(recordings, kind):
    found = timeline.items(recordings.nominal.trace)
    return [each for each in found if each["kind"] == kind]


def test_a_message_goes_from_the_node_to_who_hears_it(recorded):
    first = items(recorded["talker"], "message")[0]
    assert (first["from"], first["to"]) == ("/minimal_publisher", ["/listener"])
    assert (first["what"], first["text"]) == ("/topic", "Hello World: 0")


def test_a_log_line_stands_with_its_node_and_level(recorded):
    first = items(recorded["talker"], "log")[0]
    assert (first["from"], first["what"]) == ("/minimal_publisher", "INFO")
    assert first["text"] == 'Publishing: "Hello World: 0"'


def test_calls_and_goals_last_from_the_question_to_the_answer(recorded):
    (call,) = items(recorded["service_client"], "call")
    assert call["to"] == ["/server"]
    assert call["end"] >= call["t"]
    assert call["text"] == '{"a": 2, "b": 3} → 5'
    goal = items(recorded["action_server"], "goal")[0]
    assert goal["from"] == "/caller"
    assert goal["t"] < min(goal["marks"]) <= max(goal["marks"]) < goal["end"]


def test_each_of_several_programs_has_its_lanes():
    folder = FOLDER / "talker_listener" / "right" / "official"
    made = grader.record(folder, "talker_listener").nominal.trace
    assert timeline.lanes(made) == ["/minimal_publisher", "/minimal_subscriber"]
    assert timeline.labels(made)["/minimal_subscriber"] == "[listener-2] /minimal_subscriber"


def page_of(recordings):
    render = load_scene("graph").player
    return render(playback.of("it", recordings, None))


@pytest.fixture(scope="module")
def browser():
    with open_browser() as opened:
        yield opened


@needs_browser
def test_the_list_follows_the_cursor(recorded, browser, tmp_path):
    (tmp_path / "view.html").write_text(page_of(recorded["talker"]))
    page = browser.new_page()
    page.goto((tmp_path / "view.html").as_uri())
    current = page.locator("#hops tr[aria-current]")
    assert current.count() == 0
    page.locator("#slider").focus()
    page.keyboard.press("End")
    assert "Hello World: 10" in current.inner_text()
    page.keyboard.press("Home")
    assert current.count() == 0
    page.select_option("#about", "/topic")
    assert page.locator("#hops tr.log").count() == 0


@needs_browser
def test_what_a_program_says_stays_text(browser, tmp_path):
    made = trace(endpoint("topic /chatter"), text(1, "/chatter", HOSTILE), line(1, HOSTILE))
    assert isinstance(made, CastTrace)
    assert made.messages[1].topic == ROSOUT
    (tmp_path / "view.html").write_text(page_of(Recordings(Recording(made, scene="graph"))))
    page = browser.new_page()
    alerts = []
    page.on("dialog", lambda dialog: alerts.append(dialog))
    page.goto((tmp_path / "view.html").as_uri())
    assert page.locator("#hops img").count() == 0
    assert "onerror" in page.locator("#hops").inner_text()
    assert not alerts


@needs_browser
def test_a_live_page_grows(recorded, browser):
    made = recorded["talker"].nominal.trace
    every = timeline.items(made)
    served = TimelinePage.serve(0)
    try:
        page = browser.new_page()
        page.goto(served.address)
        assert served.await_viewer(60)
        served.update(Grading("official.py", "nominal run"))
        lanes = timeline.lanes(made)
        served.hear([{"t": 1.0, "lanes": lanes, "labels": {}, "items": every[:2]}])
        page.locator("#hops tr").nth(1).wait_for()
        served.hear([{"t": 6.0, "lanes": lanes, "labels": {}, "items": every[2:]}])
        page.locator("#hops tr").nth(len(every) - 1).wait_for()
        assert "Hello World: 10" in page.locator("#hops").inner_text()
        assert "official.py" in page.locator("#state").inner_text()
        page.select_option("#language", "fr")
        page.get_by_text("Ce qui est allé de l'un à l'autre").wait_for()
    finally:
        served.close()
