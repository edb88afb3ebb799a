import re
import subprocess

import pytest

from grader.reports import read as read_report
from grader.reports.page import html
from tests.browser import clipped, needs_browser
from tests.grader.driving import Spiral, drive
from tests.grader.reports import samples
from tests.grader.reports.samples import evidence, verdict
from tests.needs import needs

pytestmark = needs_browser


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """The fault is in the middle of varied run 1; nothing is wrong in the two others."""
    good = drive(Spiral())
    verdicts = [
        verdict("starts", evidence=[evidence("it starts", 0.16)]),
        verdict("stops", "failed", 0, evidence=[evidence("too far", 30.0, run=1)]),
    ]
    folder = tmp_path_factory.mktemp("graded")
    read = read_report(samples.graded(folder, good, *verdicts, varied=(good, good), output="one"))
    path = folder / "page.html"
    path.write_text(html.render(read))
    return path


@pytest.fixture(scope="module")
def shown(browser, page):
    opened = browser.new_page()
    opened.goto(page.as_uri())
    return opened


def test_it_opens_at_the_run_and_the_moment_of_the_first_fault(shown):
    shown = shown.content()
    tabs = dict(re.findall(r'data-show="(\d)" aria-pressed="(\w+)"', shown))
    assert tabs == {"0": "false", "1": "true", "2": "false"}
    hidden = re.findall(r'<div class="run[^"]*" data-run="(\d)"( hidden="")?>', shown)
    assert hidden == [("0", ' hidden=""'), ("1", ""), ("2", ' hidden=""')]
    assert "30.0 s" in re.findall(r"<output>(.*?)</output>", shown)


def test_cards_columns_and_tables_show_all_that_they_hold(shown):
    assert clipped(shown) == {}


@needs("pdftotext")
def test_on_paper_is_the_run_with_the_fault_and_no_control(shown, tmp_path):
    pdf = tmp_path / "page.pdf"
    shown.pdf(path=pdf)
    listed = ["pdftotext", str(pdf), "-"]
    said = subprocess.run(listed, capture_output=True, text=True, check=True).stdout
    said = " ".join(said.split())
    assert "Fix this first: Title of stops" in said
    assert "Where the turtle went Varied run 1: from (4.00, 7.00)" in said
    assert "Title of stops: varied run 1, at 30.00 s" in said
    assert "top left (quadrant II): mostly red" in said
    for control in ("Speed 1×", "5×", "Play", "Show the whole path", "Varied run 1, 1 pin"):
        assert control not in said
    assert said.count("at rest from") == 1  # below one picture
