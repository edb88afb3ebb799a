"""Everybody can use every page: axe-core finds no obstacle, on a telephone and on a desk.

The live page is in tests/turtlesim_py/live.
"""

from dataclasses import replace

import pytest

from grader.exercise.loading import load_exercise
from grader.exercise.result.json_file import ErrorResult
from grader.reports import ErrorReport
from grader.reports import read as read_report
from grader.reports.page import html
from grader_class.page import html as class_page
from tests.barriers import barriers
from tests.browser import needs_browser
from tests.grader.driving import Spiral, drive
from tests.grader.reports import samples
from tests.grader.reports.samples import evidence, verdict
from tests.grader_class.page.classes import entry, result
from tests.grader_robots.reports.test_parts import package_trace, page_of

pytestmark = needs_browser

FAULT = verdict("stops", "failed", 0, evidence=[evidence("too far", 30.0, run=1)])


def report_of_turtles(folder):
    good = drive(Spiral(), 700)
    verdicts = (verdict("starts", evidence=[evidence("it starts", 0.16)]), FAULT)
    return html.render(
        read_report(samples.graded(folder, good, *verdicts, varied=(good, good), output="one"))
    )


def report_of_a_crash(folder):
    short = drive(Spiral(), 125)
    run = replace(short.run, outcome="crashed", exit_code=1)
    recording = replace(short, run=run, output="Traceback (most recent call last):\nNameError")
    return html.render(read_report(samples.graded(folder, recording, FAULT)))


def report_of_a_package(folder):
    return page_of(folder, package_trace(), "package", FAULT)


def page_of_a_class(folder):
    told = "NameError: Zoë is not 1"
    class_of_three = [
        entry("zoe17", result({"moves": 0.0}, told), name="Zoë Müller"),
        entry("bob18", result({"moves": 10.0}), name="Bob Brown"),
        entry("kim19", state="nothing", message="kim19 handed in nothing.", name="Kim"),
    ]
    return class_page.render_all(class_of_three, load_exercise("turtlesim_challenge"))[
        class_page.PAGE
    ]


def page_without_a_result(folder):
    error = ErrorResult("submission", "Found no .py file; hand in one.", 100)
    return html.render_error(ErrorReport(error, folder))


PAGES = (report_of_turtles, report_of_a_crash, report_of_a_package, page_of_a_class)


@pytest.mark.parametrize("made", [*PAGES, page_without_a_result], ids=lambda made: made.__name__)
def test_nothing_stands_in_anybodys_way(made, browser, tmp_path):
    path = tmp_path / "page.html"
    path.write_text(made(tmp_path / "of"), encoding="utf-8")
    page = browser.new_page(reduced_motion="reduce")
    page.goto(path.as_uri())
    assert barriers(page) == []
    page.close()


FAULTY = {
    "": "<button>Go</button> <a href='#go'>there</a>",
    "no focus seen": "<style>a:focus { outline: 2px solid #ddd }</style><a href='#go'>there</a>",
    "covered": "<p style='position: fixed; inset: 0; background: #fff'></p><button>Go</button>",
    "never comes to": "<button onkeydown='event.preventDefault()'>Go</button><button>On</button>",
    "scrolls sideways": "<p style='width: 700px'>much</p>",
    "faint": "<label>a <input type='text' style='border: 1px solid #ddd'></label>",
    "cut": "<p style='height: 1.2em; width: 150px; overflow: hidden'>a little too much</p>",
    "target-size": "<button aria-label='a' style='padding: 0; width: 9px'></button>" * 2,
    "label-content-name-mismatch": "<button aria-label='One tick'>back</button>",
    "it moves": "<style>p { animation: k 9s } @keyframes k { to { margin: 0 } }</style><p>x</p>",
}


@pytest.mark.parametrize("fault", FAULTY)
def test_a_barrier_of_each_kind_is_found(fault, browser):
    page = browser.new_page(reduced_motion="reduce")
    body = f"<title>t</title><main><h1>t</h1>{FAULTY[fault]}</main>"
    page.set_content(f"<!DOCTYPE html><html lang='en'>{body}</html>")
    found = barriers(page)
    page.close()
    assert [each for each in found if fault in each] if fault else found == []
