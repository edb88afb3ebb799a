import csv
import io
import json
import re
from functools import cache

import pytest

from grader.cli import main
from grader.exercise.result.result import SubmissionInfo
from grader.reports import read as read_report
from grader.reports import render
from grader.reports.wording import duration
from grader.system.strict_json import to_json
from tests.grader.driving import Spiral, drive
from tests.grader.exercise.result.test_result import DUE, LATE, POLICY
from tests.grader.reports import samples
from tests.grader.reports.readers import READERS
from tests.grader.reports.samples import FORMATS

#: Made for teachers: a table of a class; and Gradescope hides what the file tells it to.
FOR_STUDENTS = sorted(set(FORMATS) - {"csv", "gradescope"})
#: Whatever is said of a hidden check has this in it.
MARK = "hush"
TIMES = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ")


@cache
def recorded():
    return drive(Spiral(), ticks=400)


def secret(visible="never", status="failed", score=3.17):
    return samples.verdict(
        f"{MARK}_check",
        status,
        score,
        max_score=31.7,
        visible=visible,
        title=f"The {MARK} title",
        rationale=f"The {MARK} rationale.",
        help=f"The {MARK} help.",
        evidence=[samples.evidence(f"the {MARK} note", 17.77)],
    )


def written(folder, *verdicts):
    """A result as it lies in a graded folder, led by the hidden check, for it costs most."""
    words = {"cause": f"The {MARK} rationale.", "help": f"The {MARK} help."}
    diagnosis = samples.diagnosis(key="check", check=f"{MARK}_check", **words)
    return samples.graded(folder, recorded(), *verdicts, diagnosis=diagnosis)


def shown_in(names, path, view="student"):
    """What people read in reports of some formats, by format."""
    report = read_report(path, view=view)
    return {name: TIMES.sub("", samples.read_by_people(name, report)) for name in names}


def scores(names, path, view="student"):
    """What course systems read in them."""
    report = read_report(path, view=view)
    return {name: READERS[name](render(name, [report])) for name in names}


@pytest.mark.parametrize("visible", ["never", "after_due"])
def test_no_text_of_a_hidden_check_is_in_any_report_for_students(tmp_path, visible):
    path = written(tmp_path, *samples.MIXED, secret(visible))
    for name, content in shown_in(FOR_STUDENTS, path).items():
        assert MARK not in content.lower(), name
        assert "17.77" not in content, name
        assert "31.7" in content, name  # what is not shown is told, by its points
    expected = dict.fromkeys(FOR_STUDENTS, 18.33) | {"classroom50": 18}
    assert scores(FOR_STUDENTS, path) == expected


@pytest.mark.parametrize("passed", [True, False], ids=["the rest passed", "the rest did not"])
def test_a_report_for_students_is_the_same_whatever_came_of_hidden_checks(tmp_path, passed):
    others = [samples.verdict("starts")] if passed else samples.MIXED
    path = written(tmp_path, *others, secret())
    failed = shown_in(FOR_STUDENTS, path)
    made = samples.result(*others, secret(status="passed", score=31.7))
    if not passed:
        made["diagnosis"] = samples.diagnosis(key="check", cause="Other.", check="draws")
    made["artifacts"] = json.loads(path.read_text())["artifacts"]
    path.write_text(json.dumps(made))
    assert shown_in(FOR_STUDENTS, path) == failed
    if passed:
        words = "1 check worth 31.7 points is not shown here, nor counted in this score."
        all_passed = re.compile(r"\b(all|only)\b[^.]{0,12}\bchecks?\b[^.]{0,5}passed", re.I)
        for name, content in failed.items():
            assert words in content and not all_passed.search(content), name


def test_where_nothing_at_all_is_shown_nothing_is_earned_yet(tmp_path):
    path = written(tmp_path, secret())
    assert set(scores(FOR_STUDENTS, path).values()) == {0}
    contents = shown_in(FORMATS, path)
    assert [name for name in FOR_STUDENTS if MARK in contents[name]] == []
    assert json.loads(render("prairielearn", [read_report(path)]))["score"] == 0


def test_of_points_only_every_format_shows_the_points_and_no_finding(tmp_path):
    path = written(tmp_path, *samples.MIXED, secret("points_only"))
    names = sorted(set(FORMATS) - {"csv"})
    for name, content in shown_in(names, path).items():
        assert f"The {MARK} title" in content or name == "autolab"
        for words in ("rationale", "help", "note"):
            assert f"the {MARK} {words}" not in content.lower(), name
        assert "What was found is not shown" in content, name
    assert scores(names, path) == dict.fromkeys(names, 21.5) | {"classroom50": 215}


def test_a_teacher_sees_all_and_what_students_see_of_it(tmp_path):
    path = written(tmp_path, *samples.MIXED, secret())
    for name, content in shown_in(set(FORMATS) - {"csv"}, path, "whole").items():
        content = " ".join(content.split())
        for words in ("rationale", "note"):
            assert f"the {MARK} {words}" in content.lower(), name
        assert "not shown here" not in content, name
        if name in ("terminal", "html", "markdown"):
            assert "students never see it" in content, name


def test_when_the_exercise_is_over_students_see_what_waited_for_that(tmp_path):
    path = written(tmp_path, *samples.MIXED, secret("after_due"))
    for name, content in shown_in(FOR_STUDENTS, path, "after_due").items():
        assert f"the {MARK} rationale" in content.lower(), name
        assert "not shown" not in content and "students see it" not in content, name
    found = scores(FOR_STUDENTS, path, "after_due")
    assert found == dict.fromkeys(FOR_STUDENTS, 21.5) | {"classroom50": 215}


def test_gradescope_hides_by_its_own_means_and_has_all_points(tmp_path):
    others = [
        secret("after_due") | {"check": "later", "title": "Later"},
        secret("points_only", "passed", 31.7) | {"check": "part", "title": "Part"},
    ]
    path = written(tmp_path, *samples.MIXED, secret(), *others)
    content = render("gradescope", [read_report(path)])
    assert READERS["gradescope"](content) == 56.37
    document = json.loads(content)
    tests = {test["name"].partition(":")[0]: test for test in document["tests"]}
    assert {name: test["visibility"] for name, test in tests.items()} == {
        **dict.fromkeys(("starts", "draws", "stops", "rests", "part"), "visible"),
        f"{MARK}_check": "hidden",
        "later": "after_due_date",
    }
    assert f"The {MARK} rationale." in tests[f"{MARK}_check"]["output"]
    seen = [test for test in document["tests"] if test["visibility"] == "visible"]
    assert MARK not in json.dumps([seen, document["output"]])
    over = json.loads(render("gradescope", [read_report(path, view="after_due")]))["tests"]
    assert [test["visibility"] for test in over].count("hidden") == 1
    whole = json.loads(render("gradescope", [read_report(path, view="whole")]))["tests"]
    assert not [test for test in whole if "visibility" in test]


def test_a_table_of_a_class_is_for_its_teacher(tmp_path):
    path = written(tmp_path, *samples.MIXED, secret())
    header, row = csv.reader(io.StringIO(render("csv", [read_report(path)])))
    told = dict(zip(header, row, strict=True))
    assert (told["score"], told[f"{MARK}_check"]) == ("21.5", "3.17")


def test_where_nothing_is_hidden_everybody_reads_the_same(tmp_path):
    path = samples.graded(tmp_path, recorded(), *samples.MIXED)
    views = ("student", "after_due", "whole")
    student, after_due, whole = (shown_in(FORMATS, path, view) for view in views)
    assert student == after_due == whole


def late(folder, *verdicts):
    listed = verdicts or (samples.verdict("draws", "failed", 87.5, max_score=100),)
    return samples.graded(folder, recorded(), *listed, handed_in=to_json(LATE))


def test_what_lateness_costs_is_told(tmp_path):
    path = late(tmp_path)
    names = ["terminal", "html", "markdown", "moodle-vpl"]
    for name, content in shown_in([*names, "prairielearn"], path).items():
        plain = " ".join(content.split())
        assert "Handed in 1 day 3 h late: 20 points less; 67.5 instead of 87.5." in plain, name
        told = "Zoë Müller, attempt 2, handed in 2026-12-02 01:59:00+00:00." in plain
        assert told or name == "prairielearn"
    assert scores(names, path) == dict.fromkeys(names, 67.5)


def test_what_lateness_costs_does_not_tell_what_hidden_checks_gave(tmp_path):
    path = late(tmp_path, *samples.MIXED, secret())
    content = shown_in(["html"], path)["html"]
    assert "Handed in 1 day 3 h late: 20 points less in the total of all checks." in content
    assert scores(["html"], path) == {"html": 18.33}
    assert "21.5" not in content.partition("<script")[0].partition("<figure>")[0]


@pytest.mark.parametrize(
    ("hand_in", "words"),
    [
        (SubmissionInfo.of("4711", "", 1, DUE, POLICY), "4711, attempt 1, handed in 2026-11-30 22"),
        (SubmissionInfo.of("4711", "Zoë", 1, None, None), "Zoë, attempt 1."),
        (SubmissionInfo("4711", "Zoë", 1, DUE, 300), "Handed in 5 min late, which costs no points"),
    ],
)
def test_who_was_in_time_is_told_so(hand_in, words):
    report = samples.report(handed_in=to_json(hand_in))
    assert (report.score, report.deducted) == (18.33, 0)
    assert words in " ".join(report.notes)


def test_a_duration_is_told_as_people_count():
    told = {0.2: "1 s", 40: "40 s", 300: "5 min", 7800: "2 h 10 min", 97_200: "1 day 3 h"}
    told[2 * 86_400 + 59] = "2 days"
    assert {seconds: duration(seconds) for seconds in told} == told


def test_the_verb_shows_students_less_than_teachers(tmp_path, capsys, monkeypatch):
    path = str(written(tmp_path, *samples.MIXED, secret("after_due")))
    summary = tmp_path / "summary.md"
    monkeypatch.setenv("GITHUB_STEP_SUMMARY", str(summary))
    said = []
    for words in ([], ["--after-due"], ["--whole", "--github-summary"]):
        assert main(["report", path, "--format", "markdown", *words]) == 0
        said.append(MARK in capsys.readouterr().out)
    assert said == [False, True, True]
    assert MARK not in summary.read_text(encoding="utf-8")
    assert main(["report", path, "--after-due", "--whole"]) == 2


def test_the_checks_of_an_error_are_those_that_students_know(tmp_path, capsys):
    mine = tmp_path / "mine.yaml"
    mine.write_text("exercise: turtlesim_challenge\nvisible: {edge_stop: never}\n")
    error = tmp_path / "error.json"
    schema = {"schema": "turtlesim-grader/error/v1", "whose": "submission"}
    error.write_text(json.dumps(schema | {"message": "Nothing is there.", "max_score": 100}))
    words = ["report", str(error), "--format", "autolab", "--exercise", str(mine)]
    assert main(words) == 0
    assert "edge_stop" not in capsys.readouterr().out
    assert main([*words, "--whole"]) == 0
    assert "edge_stop" in capsys.readouterr().out
