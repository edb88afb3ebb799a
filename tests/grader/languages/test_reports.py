"""Pages and formats in French and Chinese: no English word but names, code and students' own."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from grader import judging
from grader.errors import SubmissionError
from grader.exercise.loading import load_exercise
from grader.message import msg
from grader.recording.recording import Recordings
from grader.reports import ErrorReport, Report, render
from grader.reports.page import html
from grader.result.error import ErrorResult
from grader.result.result import Result
from grader.translations import use
from tests.grader.driving import Spiral, drive
from tests.grader.reports.samples import FORMATS

TRACEBACK = (
    'Traceback (most recent call last):\n  File "drive.py", line 39, in on_pose\n    1 / 0\n'
    "ZeroDivisionError: division by zero\n"
)
#: Shown to people; what they say is said elsewhere, e.g. in a title.
SAYING = ("aria-label", "alt", "title", "placeholder", "data-heading")
#: The same in all languages: identifiers, formats, units, names of versions and of what is theirs.
NAMES = re.compile(
    r"turtlesim_challenge|drive\.py|grader|Python|rclpy|ROS 2|UTC|SHA-256|on_pose|rad|Hz|px|"
    r"ZeroDivisionError: division by zero|Traceback \(most recent call last\):|"
    r"File \"drive\.py\", line 39, in on_pose|/?turtle1(/\w+)*|\w+_\w+|[0-9a-f]{6,}…?|domain \d+"
)
#: French and English words that are spelt alike.
ALIKE = {"fr": {"Verdicts", "Point", "Note", "Simulation", "Pause", "points"}, "zh": set[str]()}


class NearMiss(Spiral):
    def near_edge(self, tick, pose):
        return tick > 2000


def crashed(recording):
    run = replace(recording.run, outcome="crashed", exit_code=1)
    return replace(recording, run=run, output=TRACEBACK)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A right, a near-miss and a crash result, each with its recordings."""
    exercise = load_exercise("turtlesim_challenge")
    starts = exercise.starts(1)
    good, near = drive(Spiral()), drive(NearMiss())
    runs = {
        "right": Recordings(good, tuple(drive(Spiral(), start=start) for start in starts)),
        "near": Recordings(near, (near, good)),
        "crash": Recordings(crashed(near), (near, near)),
    }
    return {
        name: (judging.judge(run, exercise, submission="drive.py"), run)
        for name, run in runs.items()
    }


class Texts(HTMLParser):
    def __init__(self, page):
        super().__init__()
        self.found, self._hidden = set(), 0
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        self._hidden += tag in ("style", "script", "pre", "code")
        self.found.update(value for name, value in attrs if name in SAYING and value)

    def handle_endtag(self, tag):
        self._hidden -= tag in ("style", "script", "pre", "code")

    def handle_data(self, data):
        if not self._hidden and data.strip():
            self.found.add(" ".join(data.split()))


def page_of(made, name, tmp_path, language):
    result, recordings = made[name]
    use(language)
    return html.render(Report.of(result, tmp_path, recordings))


def words_of(text):
    return re.findall(r"[A-Za-z]{2,}", NAMES.sub("", text))


@pytest.mark.parametrize("name", ["right", "near", "crash"])
@pytest.mark.parametrize("language", ["fr", "zh"])
def test_a_page_says_nothing_in_english(made, tmp_path, name, language):
    english = Texts(page_of(made, name, tmp_path, "en")).found
    page = page_of(made, name, tmp_path, language)
    assert f'<html lang="{language}">' in page
    same = english & Texts(page).found
    assert sorted(text for text in same if words_of(text) and text not in ALIKE[language]) == []


def test_numbers_and_dates_of_a_page_are_the_readers(made, tmp_path):
    result, recordings = made["near"]
    use("fr")
    report = Report.of(result, tmp_path, recordings)
    assert re.search(r"\d,\d\d s, en \(\d+,\d\d\s; \d+,\d\d\)", " ".join(map(str, report.points)))
    assert all(re.search(r"\d\d/\d\d/\d{4} à \d\d:\d\d UTC", s) for s in report.origin[:1])


def test_what_the_style_sheet_and_the_script_read_has_points_in_all_languages(made, tmp_path):
    data = r'(?:data-time|style|viewBox|d|x|y|cx|cy|value|max)="([^"]*)"'
    pages = [page_of(made, "near", tmp_path, language) for language in ("en", "fr")]
    assert re.findall(data, pages[0]) == re.findall(data, pages[1])


@pytest.mark.parametrize("name", sorted(set(FORMATS) - {"html", "classroom50"}))
def test_a_machine_reads_the_same_numbers_in_all_languages(made, tmp_path, name):
    result, recordings = made["near"]
    shown = []
    for language in ("en", "fr"):
        use(language)
        shown.append(render(name, [Report.of(result, tmp_path, recordings)]))
    if name in ("gradescope", "prairielearn"):
        keys = [sorted(json.loads(text)) for text in shown]
        scores = [json.loads(text)["score"] for text in shown]
        assert keys[0] == keys[1]
        assert scores[0] == scores[1]
    if name == "csv":
        heads = [text.splitlines()[0] for text in shown]
        assert heads[0] == heads[1]
    if name == "moodle-vpl":
        assert shown[0].splitlines()[-1] == shown[1].splitlines()[-1]
    if name in ("terminal", "markdown", "moodle-vpl", "junit"):
        assert shown[0] != shown[1]


def test_a_result_file_is_the_same_in_all_languages(made):
    result, _ = made["near"]
    use("fr")
    in_french = result.to_json()
    use("en")
    assert in_french == result.to_json()


def test_a_result_that_was_read_again_is_told_like_the_one_that_was_written(made, tmp_path):
    result, recordings = made["near"]
    again = Result.from_json(json.loads(json.dumps(result.to_json())))
    use("fr")
    one, other = (Report.of(each, tmp_path, recordings) for each in (result, again))
    assert one.verdicts == other.verdicts
    assert one.headline == other.headline


def test_an_error_is_told_in_the_language_of_whoever_reads_its_file(tmp_path):
    error = SubmissionError(msg("{where}: {note}", where="drive.py", note="?"))
    data = ErrorResult.of(error, 100).to_json()
    assert data["message"] == "drive.py: ?"
    use("fr")
    report = ErrorReport(ErrorResult.from_json(data), tmp_path)
    assert report.message == "drive.py\N{NO-BREAK SPACE}: ?"
    assert '<html lang="fr">' in render("html", [report])
    assert "Impossible à noter" in render("terminal", [report])


def test_names_and_states_that_are_also_words_of_ours_stay(made, tmp_path):
    result, recordings = made["right"]
    use("fr")
    report = Report.of(replace(result, submission="passed"), tmp_path, recordings)
    assert report.submission == "passed"
    assert {verdict.status for verdict in report.verdicts} == {"passed"}
