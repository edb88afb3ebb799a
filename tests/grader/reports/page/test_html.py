import base64
import hashlib
import json
import math
import re
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from grader.exercise.result.result import Result
from grader.recording.recording import Recordings
from grader.reports import Report, terminal
from grader.reports import read as read_report
from grader.reports.page import html
from tests.grader.driving import Spiral, drive, pen, twist
from tests.grader.reports import readers, samples
from tests.grader.reports.readers import elements
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
    return html.render(read_report(path))


def classes(content, tag):
    return [attrs.get("class") for attrs in elements(content, tag)]


def test_it_is_one_small_well_formed_page_that_loads_nothing(page):
    assert readers.html(page) == 12.5
    assert len(page) < 400_000
    assert all(attrs.get("aria-label") for attrs in elements(page, "svg"))
    levels = [int(tag[1]) for tag, _ in readers.balanced(page).tags if re.fullmatch("h[1-6]", tag)]
    assert levels[0] == 1
    assert all(later - earlier <= 1 for earlier, later in pairwise(levels))


def test_the_only_script_that_may_run_is_its_own(page):
    script = re.findall(r"<script>(.*?)</script>", page, re.DOTALL)[0]
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    policy = elements(page, "meta")[1]["content"]
    assert policy.startswith("default-src 'none'")
    assert f"script-src 'sha256-{digest}'" in policy


def test_each_verdict_is_a_card_with_word_sign_title_and_identifier(page):
    assert classes(page, "article") == ["card passed", "card failed", "card not_judged"]
    said = " ".join("".join(readers.balanced(page).text).split())
    for words in ("✓ passed", "✗ failed", "– not judged", "partial credit"):
        assert words in said
    assert "Waits for Title of stops." in said
    names = ["starts", "stops", "rests"]
    assert re.findall("<h3>(.*?)</h3>", page) == [f"Title of {name}" for name in names]
    assert re.findall('<code class="identifier">(.*?)</code>', page) == names
    nameless = html.render(samples.report(verdict("a", title="")))
    assert "<h3>a</h3>" in nameless and 'class="identifier"' not in nameless


def test_the_first_box_has_the_line_and_the_help_of_the_diagnosis_of_a_check_too():
    place = {"file": "a.py", "line": 29, "function": "", "text": "if self.state == 'GO':"}
    found = samples.diagnosis(key="check", check="a", place=place, help="Look at that condition.")
    lost = verdict("a", "failed", 0, help="Is publish() called?")
    content = html.render(samples.report(lost, diagnosis=found))
    box = content.partition('<section class="first')[2].partition("</section>")[0]
    assert "a.py, line 29" in box
    assert "Look at that condition." in box
    assert "Is publish() called?" not in box
    content = html.render(samples.report(verdict("a", "failed", 0), diagnosis=samples.diagnosis()))
    assert '<p class="help"><a href="#first">See the first line.</a></p>' in content
    assert "Help for a." not in content


@pytest.mark.parametrize(
    ("more", "opened"),
    [
        ({"run": 2}, {"data-opens-run": "2", "data-opens-time": "6.000"}),
        ({"run": 2, "time_s": None}, {"data-opens-run": "2"}),
        ({"check": "a"}, {"data-opens-run": "1", "data-opens-time": "1.600"}),
    ],
)
def test_it_opens_where_the_diagnosis_points_to(more, opened):
    found = {key: value for key, value in samples.diagnosis(**more).items() if value is not None}
    varied = [samples.run(), samples.run()]
    content = html.render(samples.report(*faults(1), varied_runs=varied, diagnosis=found))
    assert elements(content, "main") == [opened]
    assert set(on_paper(content)) == {"1", opened["data-opens-run"]}


def on_paper(content):
    runs = [a for a in elements(content, "div") if (a.get("class") or "").split()[:1] == ["run"]]
    return [a["data-run"] for a in runs if a["class"] == "run on-paper"]


def faults(*runs):
    return [verdict("a", "failed", 0, evidence=[evidence(run=run) for run in runs])]


@pytest.mark.parametrize(
    ("judged", "opened", "printed"),
    [
        (faults(1), "1", ["1"]),
        (faults(0, 2), "0", ["0", "2"]),
        (faults(), None, ["0"]),  # a fault of the whole run
        (faults(7), None, ["0"]),  # of a run that nothing is known of
        ([*faults(1), verdict("b", evidence=[evidence(run=2)])], "1", ["1"]),
        ([verdict("a", evidence=[evidence(run=1)])], None, ["0"]),
    ],
)
def test_it_opens_at_the_first_fault_and_on_paper_are_the_runs_with_one(judged, opened, printed):
    content = html.render(samples.report(*judged, varied_runs=[samples.run(), samples.run()]))
    at = {} if opened is None else {"data-opens-run": opened, "data-opens-time": "1.600"}
    assert elements(content, "main") == [at]
    assert on_paper(content) == printed


def test_a_run_in_which_nothing_moved_says_so_and_not_that_it_went_on(tmp_path):
    def ahead(tick, pose, arena):
        twist(arena, 1.0)

    for controller, words in (
        (lambda *_: None, "the turtle never moved"),
        (ahead, "still going"),
    ):
        result = Result.from_json(samples.result(run=samples.run(outcome="time_limit")))
        report = Report.of(result, tmp_path, Recordings(drive(controller, ticks=9)))
        assert f"Nominal run: {words}" in html.render(report).replace("the turtle was ", "")
        assert ("Run: nothing moved, " in terminal.render(report)) == (controller is not ahead)
    without = samples.report(run=samples.run(outcome="time_limit"))
    assert "Run: time limit, " in terminal.render(without)


def test_printed_text_is_shown_and_not_obeyed_and_on_paper_is_its_end(tmp_path, good):
    lines = "".join(f"line {number}\n" for number in range(99))
    lines += "</pre><script>alert(1)</script>{{ 7 * 7 }} \x1b[31mred\x1b[0m"
    content = html.render(read_report(samples.graded(tmp_path, good, output=lines)))
    readers.html(content)
    printed = "".join(readers.balanced(content).text)
    assert "</pre><script>alert(1)</script>{{ 7 * 7 }} red" in printed
    (paper,) = re.findall(r'<div class="paper">(.*?)</div>', content, re.DOTALL)
    assert "the last of 100 lines" in paper
    assert "line 98" in paper
    assert "line 74\n" not in paper


def test_what_is_counted_is_in_the_plural_unless_it_is_one(page):
    tabs = re.findall(r"<button[^>]* data-show[^>]*>(.*?)</button>", page)
    assert tabs == ["Nominal run<small>, 1 pin</small>", "Varied run 1<small>, 1 pin</small>"]
    assert "2 lines" in page
    assert "The only check passed." in html.render(samples.report(verdict("a")))
    assert not re.search(r"\b1 (pins|calls|times|lines|checks|ticks|points of)\b", page)


def test_calls_are_a_table_too(page):
    assert re.search(r"set_pen</code>: the first 12 calls as a table", page)
    table = page[page.index("<table>") : page.index("</table>")]
    columns = re.findall(r'<th scope="col">(.*?)</th>', table)
    assert columns == ["Time", "Asked for", "Where the turtle was"]
    first = " ".join(re.sub("<.*?>", " ", table.split("<tr>")[2]).split())
    assert first == "0.03 s white (255, 255, 255), 3 px top right (quadrant I)"


def test_evidence_and_picture_point_to_each_other(page):
    pins = [attrs for attrs in elements(page, "a") if (attrs.get("class") or "").startswith("pin")]
    assert [(p["id"], p["href"], p["data-run"]) for p in pins] == [
        ("pin1", "#point1", "0"),
        ("pin2", "#point2", "1"),
    ]
    lists = re.findall(r'<ul class="evidence paper">(.*?)</ul>', page, re.DOTALL)
    assert ["Title of stops: varied run 1, at 50.00 s" in text for text in lists] == [False, True]
    assert (page.count("it starts"), page.count("too far")) == (1, 2)  # the latter leads
    numbers = [a for a in elements(page, "a") if a.get("class") == "number"]
    assert {a["href"] for a in numbers} == {"#pin1", "#pin2"}


def test_every_run_has_a_picture_with_words_plots_and_an_animation(page):
    pictures = elements(page, "image")
    assert [a["href"][:22] for a in pictures] == ["data:image/png;base64,"] * 2
    assert re.match(
        r"The window at the end\. top right \(quadrant I\): mostly white \(255, 255, 255\), "
        r"[\d,]+ pixels; top left \(quadrant II\): mostly red",
        pictures[0]["aria-label"],
    )
    assert classes(page, "figure").count("plot") == 8
    data = re.findall(r'id="animations">(.*?)</script>', page, re.DOTALL)[0]
    animations = json.loads(data)
    assert animations.keys() == {"0", "1"}
    for animation in animations.values():
        (track,) = animation["tracks"]
        assert len(animation["t"]) == len(track["x"]) == len(track["y"]) == len(track["a"])
        assert track["ink"][0][2] == "#ffffff"


def test_a_full_recording_of_three_runs_with_noise_stays_under_two_megabytes(tmp_path):
    noise = np.random.default_rng(1).integers(0, 256, (500, 500, 3), dtype=np.uint8)
    drawn = drive(OtherColourEveryTick(), ticks=7500)
    worst = replace(drawn, trace=replace(drawn.trace, window=noise))
    result = Result.from_json(samples.result(varied_runs=[samples.run()] * 2))
    report = Report.of(
        result, tmp_path, Recordings(replace(worst, output="<" * 1_000_000), (worst, worst))
    )
    readers.html(html.render(report))


def test_without_recording_and_picture_the_page_says_why_and_is_whole(tmp_path):
    content = html.render(samples.report())
    readers.html(content)
    assert "no recording lies beside it" in content
    assert not elements(content, "image")
    nothing = read_report(samples.graded(tmp_path, drive(lambda *_: None, ticks=1)))
    readers.html(html.render(nothing))


def test_a_turtle_that_is_not_a_number_is_left_out(tmp_path, good):
    rows = good.trace.trajectory().rows()
    rows[100:, 1:6] = np.nan
    trajectories = {"turtle1": Trajectory.of_rows(rows)}
    broken = replace(good, trace=replace(good.trace, trajectories=trajectories))
    lost = verdict("a", "failed", 0, evidence=[evidence("lost")])
    read = read_report(samples.graded(tmp_path, broken, lost))
    # only in memory: no result file holds what is no number
    result = Result.read(read.folder / "result.json")
    (judged,) = result.verdicts
    nowhere = replace(judged.evidence[0], x=math.nan)
    result = replace(result, verdicts=(replace(judged, evidence=(nowhere,)),))
    content = html.render(Report(result, read.artifacts))
    readers.html(content)
    assert "an unknown place: lost" in content
    assert not elements(content, "circle")  # no pin, no place of rest
    assert not re.search(r'="[^"]*\b(nan|NaN)\b', content)


def test_the_foot_tells_where_the_result_comes_from():
    judged = {"date": "2026-11-22T10:00:00Z", "grader": "0.2.0", "exercise_sha256": "b" * 64}
    recorded = {"date": "2026-11-21T23:52:52Z", "grader": "0.1.0", "python": "3.12.3"}
    recorded |= {"rclpy": "7.1.6", "ros_distro": "<b>", "submission_sha256": "a" * 64, "seed": 7}
    page = html.render(samples.report(provenance={"judged": judged, "recorded": recorded}))
    foot = page.partition("<footer>")[2].partition("</footer>")[0]
    for words in ("2026-11-21 at 23:52 UTC", "Python 3.12.3", "rclpy 7.1.6", "&lt;b&gt;"):
        assert words in foot
    for words in ("2026-11-22 at 10:00 UTC by grader 0.2.0", "a" * 12, "b" * 12, "Seed 7"):
        assert words in foot
    assert "<footer>" not in html.render(samples.report())
