from __future__ import annotations

import base64
import hashlib
import json
import math
import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from grader.reports import Report
from grader.reports.page import html
from grader.result.result import Result
from tests.grader.driving import Spiral, drive, pen
from tests.grader.reports import readers, samples
from tests.grader.reports.samples import evidence, verdict
from turtlesim_py.world.trajectory import Trajectory


class OtherColourEveryTick(Spiral):
    """The largest page: never stops, another colour in every tick."""

    def near_edge(self, tick, pose):
        return False

    def watch(self, tick, pose, arena):
        pen(arena, (tick % 256, tick // 256, 99))


@pytest.fixture(scope="module")
def good():
    return drive(Spiral())


@pytest.fixture(scope="module")
def page(tmp_path_factory, good):
    verdicts = [
        verdict("starts", evidence=[evidence("it starts", 0.16)]),
        verdict("stops", "failed", 2.5, evidence=[evidence("too far", 50.0, run=1)]),
        verdict("rests", "not_judged", 0, depends_on=["stops"]),
    ]
    folder = tmp_path_factory.mktemp("graded")
    path = samples.graded(folder, good, *verdicts, varied=(good,), output="one\ntwo\n")
    return html.render(Report.read(path))


def elements(content, name):
    return [attrs for tag, attrs in readers.balanced(content).tags if tag == name]


def classes(content, tag):
    return [attrs.get("class") for attrs in elements(content, tag)]


def test_it_is_one_well_formed_page_that_loads_nothing(page):
    assert readers.html(page) == 12.5


def test_the_only_script_that_may_run_is_its_own(page):
    script = re.findall(r"<script>(.*?)</script>", page, re.DOTALL)[0]
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    policy = elements(page, "meta")[1]["content"]
    assert policy.startswith("default-src 'none'")
    assert f"script-src 'sha256-{digest}'" in policy


def test_each_verdict_is_a_card_with_word_and_sign(page):
    assert classes(page, "article") == [
        "card passed",
        "card failed",
        "card not_judged",
    ]
    said = " ".join("".join(readers.balanced(page).text).split())
    for words in ("✓ passed", "✗ failed", "– not judged", "partial credit", "Waits for stops."):
        assert words in said


def test_evidence_and_picture_point_to_each_other(page):
    pins = [attrs for attrs in elements(page, "a") if (attrs.get("class") or "").startswith("pin")]
    assert [(p["id"], p["href"], p["data-run"]) for p in pins] == [
        ("pin1", "#point1", "0"),
        ("pin2", "#point2", "1"),
    ]
    numbers = [a for a in elements(page, "a") if a.get("class") == "number"]
    assert {a["href"] for a in numbers} == {"#pin1", "#pin2"}


def test_every_run_has_a_picture_plots_and_a_film(page):
    pictures = elements(page, "image")
    assert [a["href"][:22] for a in pictures] == ["data:image/png;base64,"] * 2
    assert classes(page, "figure").count("plot") == 8
    data = re.findall(r'id="films">(.*?)</script>', page, re.DOTALL)[0]
    films = json.loads(data)
    assert films.keys() == {"0", "1"}
    for film in films.values():
        (track,) = film["tracks"]
        assert len(film["t"]) == len(track["x"]) == len(track["y"]) == len(track["a"])
        assert track["ink"][0][2] == "#ffffff"


def test_pictures_have_names_and_headings_come_in_order(page):
    for tag in ("svg",):
        assert all(attrs.get("aria-label") for attrs in elements(page, tag))
    levels = [int(tag[1]) for tag, _ in readers.balanced(page).tags if re.fullmatch("h[1-6]", tag)]
    assert levels[0] == 1
    assert all(later - earlier <= 1 for earlier, later in pairwise(levels))


def test_a_full_recording_of_three_runs_with_noise_stays_under_two_megabytes(tmp_path):
    noise = np.random.default_rng(1).integers(0, 256, (500, 500, 3), dtype=np.uint8)
    drawn = drive(OtherColourEveryTick(), ticks=7500)
    worst = replace(drawn, trace=replace(drawn.trace, window=noise))
    path = samples.graded(tmp_path, worst, varied=(worst, worst), output="<" * 1_000_000)
    readers.html(html.render(Report.read(path)))


def test_a_usual_page_of_3500_ticks_is_small(tmp_path, good):
    assert good.run.ticks > 3000
    assert len(html.render(Report.read(samples.graded(tmp_path, good)))) < 200_000


def test_printed_text_is_shown_and_not_obeyed(tmp_path, good):
    output = "</pre><script>alert(1)</script>{{ 7 * 7 }} \x1b[31mred\x1b[0m"
    content = html.render(Report.read(samples.graded(tmp_path, good, output=output)))
    readers.html(content)
    printed = "".join(readers.balanced(content).text)
    assert "</pre><script>alert(1)</script>{{ 7 * 7 }} red" in printed


def test_without_recording_and_picture_the_page_says_why_and_is_whole():
    content = html.render(samples.report())
    readers.html(content)
    assert "no recording lies beside it" in content
    assert not elements(content, "image")


def test_a_turtle_that_is_not_a_number_is_left_out(tmp_path, good):
    rows = good.trace.trajectory().rows()
    rows[100:, 1:6] = np.nan
    trajectories = {"turtle1": Trajectory.of_rows(rows)}
    broken = replace(good, trace=replace(good.trace, trajectories=trajectories))
    lost = verdict("a", "failed", 0, evidence=[evidence("lost")])
    read = Report.read(samples.graded(tmp_path, broken, lost))
    # only in memory: no result file holds what is no number
    result = Result.read(read.folder / "result.json")
    (judged,) = result.verdicts
    nowhere = replace(judged.evidence[0], x=math.nan)
    result = replace(result, verdicts=(replace(judged, evidence=(nowhere,)),))
    content = html.render(Report(result, read.beside))
    readers.html(content)
    assert "an unknown place: lost" in content
    assert not elements(content, "circle")  # no pin, no place of rest
    assert not re.search(r'="[^"]*\b(nan|NaN)\b', content)


def test_an_empty_recording_makes_a_page(tmp_path):
    path = samples.graded(tmp_path, drive(lambda *_: None, ticks=1))
    readers.html(html.render(Report.read(path)))
