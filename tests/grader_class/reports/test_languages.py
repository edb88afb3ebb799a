import json
import re
from dataclasses import replace

import pytest

from grader import judging
from grader.cli import main
from grader.errors import SubmissionError
from grader.exercise.loading import load_exercise
from grader.exercise.result.json_file import ErrorResult
from grader.recording.recording import Recordings
from grader.reports import ErrorReport, Report, render
from grader.text.message import msg
from grader.text.translations import ENGLISH, use
from tests.grader.driving import Spiral, drive


class NearMiss(Spiral):
    def near_edge(self, tick, pose):
        return tick > 2000


@pytest.fixture(autouse=True)
def english_again():
    yield
    use(ENGLISH)


@pytest.fixture(scope="module")
def judged():
    near = Recordings(drive(NearMiss()))
    exercise = load_exercise("turtlesim_challenge")
    return judging.judge(near, exercise, submission="drive.py"), near


@pytest.mark.parametrize(
    ("language", "first", "score"),
    [
        ("fr", "La tortue s'est immobilisée à 2,93 m du mur le plus proche", "Score : 75 sur 100"),
        ("zh", "海龟停在距最近的墙 2.93 米处", "得分：75 / 100"),
    ],
)
def test_a_kept_result_is_shown_in_the_language_of_the_call(
    judged, tmp_path, capsys, language, first, score
):
    result, _ = judged
    (tmp_path / "result.json").write_text(json.dumps(result.to_json()))
    words = ["report", str(tmp_path), "--format", "terminal", "--lang", language]
    assert main(words) == 0
    lines = capsys.readouterr().out.replace("\N{NO-BREAK SPACE}", " ").splitlines()
    assert first in lines[0]
    assert score in lines


@pytest.mark.parametrize("name", ["html", "gradescope", "moodle-vpl"])
def test_what_a_machine_reads_has_points_in_all_languages(judged, tmp_path, name):
    result, recordings = judged
    attributes = r'(?:data-time|style|viewBox|d|x|y|cx|cy|value|max)="([^"]*)"'
    reads = {
        "html": lambda text: re.findall(attributes, text),
        "gradescope": lambda text: json.loads(text)["score"],
        "moodle-vpl": lambda text: text.splitlines()[-1],
    }
    read = []
    for language in ("en", "fr"):
        use(language)
        read.append(reads[name](render(name, [Report.of(result, tmp_path, recordings)])))
    assert read[0] == read[1] != []


def test_a_result_file_is_the_same_in_all_languages(judged):
    result, _ = judged
    use("fr")
    in_french = result.to_json()
    use("en")
    assert in_french == result.to_json()


def test_an_error_is_told_in_the_language_of_whoever_reads_its_file(tmp_path):
    error = SubmissionError(msg("{where}: {note}", where="drive.py", note="?"))
    data = ErrorResult.of(error, 100).to_json()
    assert data["message"] == "drive.py: ?"
    use("fr")
    report = ErrorReport(ErrorResult.from_json(data), tmp_path)
    assert report.message == "drive.py\N{NO-BREAK SPACE}: ?"
    assert '<html lang="fr">' in render("html", [report])


def test_a_submission_whose_name_is_a_word_of_ours_keeps_it(judged, tmp_path):
    result, recordings = judged
    use("fr")
    report = Report.of(replace(result, submission="passed"), tmp_path, recordings)
    assert report.submission == "passed"
