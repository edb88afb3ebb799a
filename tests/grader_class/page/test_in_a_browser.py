from datetime import UTC, datetime

from grader.exercise.loading import load_exercise
from grader_class.page import html
from tests.browser import clipped, needs_browser
from tests.grader_class.page.classes import entry, result

pytestmark = needs_browser
EXERCISE = load_exercise("turtlesim_challenge")
TOLD = ("Zoë", "Müller", "zoe17", "bob18", "Bob", "Brown", "kim19", "Kim")


def shown(browser, folder, *entries):
    for name, content in html.render_all(list(entries), EXERCISE).items():
        (folder / name).write_text(content, encoding="utf-8")
    page = browser.new_page()
    page.goto((folder / "index.html").as_uri())
    return page


def test_columns_can_be_sorted_names_found_and_hidden(browser, tmp_path):
    bad = "NameError: Zoë is not 1"
    page = shown(
        browser,
        tmp_path,
        entry("zoe17", result({"moves": 0.0}, bad), name="Zoë Müller"),
        entry("bob18", result({"moves": 10.0}), name="Bob Brown"),
        entry("kim19", state="nothing", message="kim19 handed in nothing.", name="Kim"),
    )
    assert page.locator("#class th[scope=col] button[type=button]").count() == 7
    page.fill("#find", "zoe")
    assert page.inner_text("#found") == "1 of 3"
    page.fill("#find", "")
    page.hover("tr[data-of] >> nth=0")
    assert "Zoë Müller" in page.inner_text("main")
    page.click("#hide")
    assert page.url.endswith("#names-hidden")
    said = page.inner_text("main")
    assert [name for name in TOLD if name in said] == []
    rows = page.locator("#class tr[data-of] th bdi[data-name]").all_inner_texts()
    assert rows == ["Student 1", "Student 2", "Student 3"]
    assert page.locator('[aria-disabled="true"]').count() == 2


def test_names_that_are_hidden_stay_so_on_the_next_page(browser, tmp_path, monkeypatch):
    monkeypatch.setattr(html, "MOST_ROWS", 1)
    monkeypatch.setattr(html, "ROWS", 1)
    both = [entry(f"{n}1", state="nothing", name=n) for n in ("Kim", "Zoë")]
    page = shown(browser, tmp_path, *both)
    page.click("#hide")
    page.click("a.part")
    page.wait_for_url("**/index-2.html#names-hidden")
    assert "Zoë" not in page.inner_text("main")
    page.click("#hide")
    assert "Zoë" in page.inner_text("main")
    assert page.get_attribute("a.part", "href").endswith("/index.html")


def test_cards_columns_and_tables_show_all_that_they_hold(browser, tmp_path):
    points = {check: 0.0 if number % 2 else 10.0 for number, check in enumerate(EXERCISE.points)}
    at = datetime(2026, 11, 26, 14, tzinfo=UTC)
    zoe = entry("zoe_mueller_1234567", result(points), name="Zoë Müller-Lüdenscheid", at=at)
    assert clipped(shown(browser, tmp_path, zoe)) == {}
