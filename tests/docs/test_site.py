"""The site: what is laid out for it, and how it serves its readers."""

import threading
import tomllib
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

import pytest

import grader
from scripts.site import __main__ as site
from tests.browser import needs_browser, obstacles
from tests.needs import SITE, needs

EXERCISES = tomllib.loads((site.ROOT / "pyproject.toml").read_text("utf-8"))["project"][
    "entry-points"
]["grader.exercises"]


def test_links_lead_to_pages_and_files_to_the_repository():
    page = (
        "[home](../README.md#then) [other](data.md#a) [module](../grader/__init__.py) "
        "[web](https://a.b/c.md) ![it](spiral.png)"
    )
    here = site.ROOT / "docs" / "batch.md"
    assert site.with_links(here, page, "") == (
        "[home](../index.md#then) [other](data.md#a) module [web](https://a.b/c.md) "
        "![it](spiral.png)"
    )
    there = site.with_links(here, "[`run`](../.ci/run)", "https://a.b/blob/main")
    assert there == "[`run`](https://a.b/blob/main/.ci/run)"


def test_lists_are_read_as_on_github():
    assert site.for_python_markdown("It:\n- a\n  - b\n    c\n\n1. d\n\n       e\n2. f\n") == (
        "It:\n\n- a\n    - b\n        c\n\n1. d\n\n        e\n\n2. f\n"
    )


def test_the_sheet_of_an_exercise_is_the_one_that_students_get(tmp_path):
    site.write_sheets(tmp_path, ["talker"])
    page = (tmp_path / "talker.md").read_text(encoding="utf-8")
    assert page.startswith("# A node that talks\n")
    assert "    grader run my_solution\n" in page and "## What it is worth: 100 points" in page
    listed = (tmp_path / "index.md").read_text(encoding="utf-8")
    assert "| [A node that talks](talker.md) | `talker` | 100 |" in listed


# The site of the last `make docs` -----------------------------------------------------------------


class Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


@pytest.fixture(scope="module")
def address():
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=SITE)) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


@needs("site")
def test_the_site_has_a_sheet_for_each_exercise_and_each_public_name():
    listed = (SITE / "exercises" / "index.html").read_text(encoding="utf-8")
    assert [name for name in EXERCISES if f'href="{name}.html"' not in listed] == []
    api = (SITE / "api.html").read_text(encoding="utf-8")
    assert [name for name in grader.__all__ if f'href="#grader.{name}"' not in api] == []


@needs("site")
@needs_browser
@pytest.mark.parametrize(("width", "scheme"), [(375, "dark"), (1280, "light")])
def test_everybody_can_use_the_site(browser, address, width, scheme):
    page = browser.new_page(viewport={"width": width, "height": 800}, color_scheme=scheme)
    asked = []
    page.on("request", lambda request: asked.append(request.url))
    for name in ("index", "docs/course-ci", "exercises/talker", "gallery/index", "api"):
        page.goto(f"{address}/{name}.html")
        assert (name, obstacles(page)) == (name, [])
        assert page.evaluate("document.documentElement.scrollWidth") <= width, name
    page.close()
    assert [url for url in asked if not url.startswith((address, "data:"))] == []
