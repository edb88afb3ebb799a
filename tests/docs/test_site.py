"""The site: what is laid out for it, what its check finds, and how it serves its readers."""

from __future__ import annotations

import threading
import tomllib
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

import grader
from scripts.site import check, exercises, pages
from scripts.site.__main__ import navigation
from tests.browser import needs_browser, obstacles, open_browser
from tests.needs import SITE, needs

ROOT = Path(__file__).parents[2]
EXERCISES = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]["entry-points"][
    "grader.exercises"
]


def write(folder: Path, **files: str) -> None:
    for name, text in files.items():
        path = folder / name.replace("__", "/").replace("_", ".")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


# What is laid out ---------------------------------------------------------------------------------


@pytest.fixture
def laid_out(tmp_path):
    """A small repository, laid out."""
    head = 'It is.\n\n<img src="docs/it.png">\n\n**Three doors:** [in](docs/in.md)\n'
    readme = f"# It\n\n{head}\n## Then\n"
    page = (
        "[home](../README.md#then) [module](../code/run.py) [all](../code) [web](https://a.b/c.md) "
        "[gone](gone.md) [hidden](../.ci/run.sh)"
    )
    write(tmp_path / "repo", README_md=readme, docs__in_md=page, code__run_py="print('```')\n")
    write(tmp_path / "repo", **{".ci__run_sh": "make\n"})
    (tmp_path / "repo" / "docs" / "it.png").write_bytes(b"")
    pages.lay_out(tmp_path / "repo", tmp_path / "site")
    return tmp_path / "site"


def test_links_to_files_of_the_repository_lead_to_pages_that_show_them(laid_out):
    assert (laid_out / "docs" / "in.md").read_text() == (
        "[home](../index.md#then) [module](../code/run.py.md) [all](../code/files.md) "
        "[web](https://a.b/c.md) [gone](gone.md) [hidden](../ci/run.sh.md)"
    )
    assert "make" in (laid_out / "ci" / "run.sh.md").read_text()
    assert "````python\nprint('```')\n" in (laid_out / "code" / "run.py.md").read_text()
    assert "[`run.py`](run.py.md)" in (laid_out / "code" / "files.md").read_text()


def test_the_readme_is_the_landing_page(laid_out):
    text = (laid_out / "index.md").read_text()
    assert "[in](docs/in.md){ .md-button .md-button--primary }" in text
    assert text.index("It is.") < text.index('<img src="docs/it.png">') < text.index("## Then")
    assert (laid_out / "docs" / "it.png").exists()


def test_lists_are_read_as_on_github():
    assert pages.for_python_markdown("It:\n- a\n  - b\n    c\n\n1. d\n\n       e\n2. f\n") == (
        "It:\n\n- a\n    - b\n        c\n\n1. d\n\n        e\n\n2. f\n"
    )


def test_a_page_without_an_entry_has_its_place_in_the_navigation(tmp_path):
    write(tmp_path, index_md="", docs__new_md="", docs__old_md="", api__a_md="", api__b_md="")
    write(tmp_path, api__index_md="[b](b.md) [a](a.md)", setup_md=f"{pages.NOT_SEARCHED}# setup.py")
    nav = [
        {"Home": "index.md"},
        {"I learn": ["docs/old.md"]},
        {"API": ["api/index.md", "api/*.md"]},
        {"None": ["none/*.md"]},
        {"More": ["docs/*.md", "*.md"]},
    ]
    assert navigation(nav, tmp_path) == [
        {"Home": "index.md"},
        {"I learn": ["docs/old.md"]},
        {"API": ["api/index.md", "api/b.md", "api/a.md"]},
        {"More": ["docs/new.md"]},
    ]


def test_the_sheet_of_an_exercise_is_the_one_that_students_get(tmp_path):
    exercises.lay_out(tmp_path / "exercises", ["talker"])
    page = (tmp_path / "exercises" / "talker.md").read_text(encoding="utf-8")
    assert page.startswith("# A node that talks\n")
    assert "    grader run my_solution\n" in page and "## What it is worth: 100 points" in page
    listed = (tmp_path / "exercises" / "index.md").read_text(encoding="utf-8")
    assert "| [A node that talks](talker.md) | `talker` | 100 |" in listed


# What the check finds -----------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("wrong", "told"),
    {
        '<a href="gone.html">': "gone.html is not there",
        '<a href="b.html#gone">': "b.html#gone: the page has no such heading",
        '<a href="#gone">': "#gone: the page has no such heading",
        '<img src="gone.png">': "gone.png is not there",
        '<script src="https://cdn.org/a.js">': "loads https://cdn.org/a.js from elsewhere",
        '<link href="//fonts.org/a.css">': "loads //fonts.org/a.css from elsewhere",
        "<article><pre></pre></article>": "0 blocks of code on GitHub, 1 here",
    }.items(),
)
def test_what_is_wrong_with_the_site_is_told(tmp_path, wrong, told):
    write(tmp_path / "pages", index_md="# A\n", b_md="## B\n")
    right = '<a href="b.html#b"> <a href="https://a.b/c"> <a href="mailto:a@b.c">'
    write(tmp_path / "html", index_html=right, b_html='<article><h2 id="b"></h2></article>')
    assert check.problems(tmp_path / "pages", tmp_path / "html") == []
    (tmp_path / "html" / "index.html").write_text(right + wrong)
    (line,) = check.problems(tmp_path / "pages", tmp_path / "html")
    assert line.startswith(f"index.html: {told}")


def test_links_from_the_top_are_followed_where_the_site_will_be(tmp_path):
    write(tmp_path / "html", index_html="", a__404_html='<a href="/it/index.html">')
    there, elsewhere = "https://a.b/it/", "https://a.b/"
    assert check.problems(tmp_path / "pages", tmp_path / "html", there) == []
    (line,) = check.problems(tmp_path / "pages", tmp_path / "html", elsewhere)
    assert line == "a/404.html: /it/index.html is not there"


def test_a_page_that_is_missing_is_told(tmp_path):
    write(tmp_path, pages__a_md="# A\n", html__index_html="")
    assert check.problems(tmp_path / "pages", tmp_path / "html") == ["a.md became no page"]


# The site of the last `make docs` -----------------------------------------------------------------


class Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        pass


@pytest.fixture(scope="module")
def address():
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=SITE)) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


@pytest.fixture(scope="module")
def browser():
    with open_browser() as opened:
        yield opened


@needs("site")
def test_the_site_has_a_sheet_for_each_exercise_and_each_public_name():
    listed = (SITE / "exercises" / "index.html").read_text(encoding="utf-8")
    assert [name for name in EXERCISES if f'href="{name}.html"' not in listed] == []
    api = (SITE / "api" / "grader.html").read_text(encoding="utf-8")
    assert [name for name in grader.__all__ if f'href="#grader.{name}"' not in api] == []


@needs("site")
@needs_browser
@pytest.mark.parametrize(("width", "scheme"), [(375, "dark"), (1280, "light")])
def test_everybody_can_use_the_site(browser, address, width, scheme):
    names = ["index", "docs/course-ci", "exercises/talker", "gallery/index", "api/testing"]
    page = browser.new_page(viewport={"width": width, "height": 800}, color_scheme=scheme)
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    for name in names:
        page.goto(f"{address}/{name}.html")
        assert (name, obstacles(page)) == (name, [])
        assert page.evaluate("document.documentElement.scrollWidth") <= width, name
    page.close()
    assert [url for url in asked if not url.startswith((address, "data:"))] == []


@needs("site")
@needs_browser
def test_the_site_is_read_without_javascript(browser, address):
    page = browser.new_page(viewport={"width": 1280, "height": 800}, java_script_enabled=False)
    page.goto(f"{address}/index.html")
    page.get_by_role("link", name="I teach").first.click()
    page.get_by_role("link", name="Exercises", exact=True).first.click()
    page.get_by_role("link", name="A node that talks").last.click()
    assert page.get_by_role("heading", name="What it is worth: 100 points").is_visible()
    page.set_viewport_size({"width": 375, "height": 800})
    page.locator("label.md-header__button[for=__drawer]").click()
    page.get_by_role("link", name="A node that listens").first.click()
    assert page.url.endswith("/exercises/listener.html")


@needs("site")
@needs_browser
def test_what_is_looked_for_is_found(browser, address):
    page = browser.new_page()
    page.goto(f"{address}/docs/batch.html")
    page.get_by_role("button", name="Search").first.click()
    page.get_by_role("combobox", name="Search").fill("one turtle follows another")
    page.get_by_role("option", name="One turtle follows another").first.click()
    page.wait_for_url("**/exercises/tf2_listener.html*")
    page.close()
