import base64
import hashlib
import re
from datetime import UTC, datetime

import pytest

from grader.exercise.loading import load_exercise
from grader.recording.recording import Recordings
from grader_class.page import html
from grader_class.page.thumb import THUMB, thumb
from tests.grader.driving import Spiral, drive
from tests.grader.reports import readers
from tests.grader.reports.readers import elements
from tests.grader_class.page.classes import entry, first_page, result

EXERCISE = load_exercise("turtlesim_challenge")
BAD, GOOD = {"moves": 10.0, "spiral": 2.5}, {"moves": 10.0, "spiral": 10.0}
EVIL = "\"><script>alert(1)</script>' onload='x"


@pytest.fixture(scope="module")
def some(tmp_path_factory):
    """Five of them; only Zoë has a picture."""
    zoe = tmp_path_factory.mktemp("zoe")
    (zoe / THUMB).write_bytes(thumb(Recordings(drive(Spiral()))))
    at = datetime(2026, 11, 1, 12, tzinfo=UTC)
    return [
        entry("zoe", result(GOOD), name="Zoë Müller", folder=zoe, at=at),
        entry("bob", result(BAD), name="Bob"),
        entry("eve", result(BAD, EVIL), name=EVIL),
        entry("dan", state="unusable", message=f"The zip {EVIL} is damaged.", name="Dan"),
        entry("kim", state="nothing", message="Nothing was handed in.", name="Kim"),
        entry("uma", state="failed", message="The disk is full.", name="Uma"),
    ]


@pytest.fixture(scope="module")
def page(some):
    return first_page(some, EXERCISE, {"Gradebook": "gradebook.csv"})


def test_it_is_well_formed_and_loads_nothing(page):
    readers.balanced(page)
    policy = next(a["content"] for a in elements(page, "meta") if "http-equiv" in a)
    (script,) = re.findall(r"<script>(.*?)</script>", page, re.DOTALL)
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert policy == (
        "default-src 'none'; img-src data:; style-src 'unsafe-inline'; "
        f"script-src 'sha256-{digest}'"
    )
    assert all(attrs["src"].startswith("data:image/png;base64,") for attrs in elements(page, "img"))


def test_a_path_is_drawn_and_a_picture_shown_for_who_has_one_and_what_strangers_wrote_is_text(page):
    assert len(re.findall(r'<path data-of="\d+" d="M[\d l-]+"/>', page)) == 1
    assert len(elements(page, "img")) == 1
    assert "<script>alert" not in page
    for _, attrs in readers.balanced(page).tags:
        assert not [name for name in attrs if name.startswith("on")]


def test_links_lead_to_what_lies_beside_it(page):
    links = {attrs["href"] for attrs in elements(page, "a") if "href" in attrs}
    reports = {f"submissions/{id}/report.html" for id in ("zoe", "bob", "eve")}
    assert {link for link in links if not link.startswith("#")} == {"gradebook.csv", *reports}


def test_every_name_and_id_stands_where_the_script_can_replace_it(page):
    text = re.sub(r'<bdi data-(name|id)="\d+">.*?</bdi>', "", page)
    text = re.sub(r'href="submissions/.*?"', "", text)
    text = re.sub(r'<(span|small) class="named">.*?</\1>', "", text)
    for told in ("Zoë", "Müller", "zoe", "Bob", "bob", "alert(1)", "Dan", "Kim", "uma"):
        assert told not in text


def test_nobody_is_missing_in_the_table(page):
    body = page.partition('<table id="class">')[2]
    assert len(re.findall(r'<tr data-of="\d+">', body)) == 6
    assert body.count("–</b>") == 1  # the grader's own failure is no 0
    assert '<data value="11.25">11.2</data>' in page  # of 20, 12.5, 12.5 and 0
    assert "1 nothing handed in" in page
    assert '<time datetime="2026-11-01T12:00:00+00:00">2026-11-01 12:00+00:00</time>' in body


def test_it_depends_on_nothing_but_the_entries(some, page):
    pages = html.render_all(list(reversed(some)), EXERCISE, {"Gradebook": "gradebook.csv"})
    assert pages == {"index.html": page}
    assert 'class="part"' not in page  # leads to no other


def test_a_class_without_results_or_anybody_has_a_page():
    readers.balanced(first_page([], EXERCISE))
    page = first_page([entry("kim", state="nothing")], EXERCISE)
    assert "Nothing was judged." in page
    readers.balanced(page)


def test_three_hundred_pictures_and_paths_have_less_than_three_megabytes(some):
    def size(count):
        same = {"name": "A name " * 5, "folder": some[0].folder}
        many = [entry(f"s{k}", some[0].result, **same) for k in range(count)]
        return len(first_page(many, EXERCISE).encode())

    assert size(20) + 28 * (size(20) - size(10)) < 3_000_000


def test_a_class_of_no_end_has_a_page_of_bounded_length(some, monkeypatch):
    monkeypatch.setattr(html, "MOST_ROWS", 20)
    monkeypatch.setattr(html, "ROWS", 20)
    monkeypatch.setattr(html, "MOST_PICTURES", 5)
    zoe = some[0]
    page = first_page([entry(f"s{k}", zoe.result, folder=zoe.folder) for k in range(50)], EXERCISE)
    assert len(elements(page, "img")) == 5
    assert len(re.findall(r'<tr data-of="\d+">', page)) == 20


def test_a_large_class_has_everybody_once_on_pages_that_lead_to_each_other(some, monkeypatch):
    monkeypatch.setattr(html, "MOST_ROWS", 20)
    monkeypatch.setattr(html, "ROWS", 20)
    zoe, names = some[0], ["index.html", "index-2.html", "index-3.html"]
    many = [entry(f"s{k}", zoe.result, folder=zoe.folder) for k in range(50)]
    pages = html.render_all(many, EXERCISE)
    assert list(pages) == names
    rows = [re.findall(r'<tr data-of="(\d+)">', page) for page in pages.values()]
    assert list(map(len, rows)) == [20, 20, 10]
    assert len({number for each in rows for number in each}) == 50
    for name, page in pages.items():
        readers.balanced(page)
        links = [a["href"] for a in elements(page, "a") if a.get("class") == "part"]
        assert links == [other for other in names if other != name]
        assert ("<svg" in page) == ("The checks in figures" in page) == (name == "index.html")
