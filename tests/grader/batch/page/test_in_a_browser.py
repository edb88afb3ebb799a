"""The class page as a browser shows it; where there is no Chromium, nothing of this is asked."""

from __future__ import annotations

import re
import subprocess
from datetime import UTC, datetime

import pytest

from grader.batch.page import html
from grader.exercise.loading import load_exercise
from tests.browser import BROWSER, clipped, needs_browser, open_browser
from tests.grader.batch.page.classes import entry, first_page, result

pytestmark = needs_browser


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    bad = "NameError: Zoë is not 1"
    path = tmp_path_factory.mktemp("class") / "index.html"
    shown = first_page(
        [
            entry("zoe17", result({"moves": 0.0}, bad), name="Zoë Müller"),
            entry("bob18", result({"moves": 10.0}), name="Bob Brown"),
            entry("kim19", state="nothing", message="kim19 handed in nothing.", name="Kim"),
        ],
        load_exercise("turtlesim_challenge"),
    )
    path.write_text(shown, encoding="utf-8")
    return path


def shown(page, fragment=""):
    """The document once the script has run."""
    usual = ("--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={page.parent}/user")
    command = [BROWSER, *usual, "--dump-dom", page.as_uri() + fragment]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def seen(dom):
    """Its text and the attributes of what is not hidden; without script and style."""
    dom = re.sub(r"<(script|style)>.*?</\1>", "", dom, flags=re.DOTALL)
    return re.sub(r'<(\w+) class="named" hidden="">.*?</\1>', "", dom)


def test_columns_can_be_sorted_and_names_found(page):
    dom = shown(page)
    assert len(re.findall(r"<th scope=\"col\"[^>]*><button type=\"button\">", dom)) == 7
    assert re.search(r'<div class="tools" role="search" aria-label="[^"]*">', dom)
    assert "Zoë Müller" in seen(dom)


def test_hidden_names_are_nowhere(page):
    dom = seen(shown(page, "#names-hidden"))
    for told in ("Zoë", "Müller", "zoe17", "bob18", "Bob", "Brown", "kim19", "Kim"):
        assert told not in dom
    table = re.sub(r">\s+<", "><", dom.partition('<table id="class">')[2])
    rows = re.findall(r'<tr data-of="\d"><th scope="row">.*?>(Student \d)</bdi>', table)
    assert rows == ["Student 1", "Student 2", "Student 3"]
    assert dom.count('aria-disabled="true"') == 2


def test_what_is_found_is_counted_and_a_chosen_name_is_hidden_too(page):
    with open_browser() as browser:
        there = browser.new_page()
        there.goto(page.as_uri())
        there.fill("#find", "zoe")
        assert there.inner_text("#found") == "1 of 3"
        there.fill("#find", "")
        there.hover("tr[data-of] >> nth=0")
        there.click("#hide")
        assert there.url.endswith("#names-hidden")
        assert not any(name in there.inner_text("main") for name in ("Zoë", "Bob", "Kim"))


def test_names_that_are_hidden_stay_so_on_the_next_page(tmp_path, monkeypatch):
    monkeypatch.setattr(html, "MOST_ROWS", 1)
    monkeypatch.setattr(html, "ROWS", 1)
    both = [entry("kim", state="nothing", name="Kim"), entry("zoe", state="nothing", name="Zoë")]
    pages = html.render_all(both, load_exercise("turtlesim_challenge"))
    for name, content in pages.items():
        (tmp_path / name).write_text(content, encoding="utf-8")
    with open_browser() as browser:
        page = browser.new_page()
        page.goto((tmp_path / "index.html").as_uri())
        page.click("#hide")
        page.click("a.part")
        page.wait_for_url("**/index-2.html#names-hidden")
        assert "Zoë" not in page.inner_text("main")
        page.click("#hide")
        assert "Zoë" in page.inner_text("main")
        assert page.get_attribute("a.part", "href").endswith("/index.html")


def test_cards_columns_and_tables_show_all_that_they_hold(tmp_path):
    exercise = load_exercise("turtlesim_challenge")
    points = {check: 0.0 if number % 2 else 10.0 for number, check in enumerate(exercise.points)}
    at = datetime(2026, 11, 26, 14, tzinfo=UTC)
    everybody = [entry("zoe_mueller_1234567", result(points), name="Zoë Müller-Lüdenscheid", at=at)]
    (tmp_path / "index.html").write_text(first_page(everybody, exercise), encoding="utf-8")
    with open_browser() as browser:
        page = browser.new_page()
        page.goto((tmp_path / "index.html").as_uri())
        assert clipped(page) == {}
