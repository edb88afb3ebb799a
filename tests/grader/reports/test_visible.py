"""What is hidden from students is in no report for them; teachers see all of it."""

from __future__ import annotations

import base64
import csv
import io
import json
import re

import pytest

from grader.cli import main
from grader.exercise.policies import LatePolicy
from grader.reports import read as read_report
from grader.reports import render
from grader.reports.wording import duration
from grader.result.result import Result, SubmissionInfo
from grader.strict_json import to_json
from tests.grader.driving import Spiral, drive
from tests.grader.reports import samples
from tests.grader.reports.readers import READERS
from tests.grader.reports.samples import FORMATS
from tests.grader.result.test_result import DUE, LATE, POLICY

#: Made for teachers: a table of a class; and Gradescope hides what the file tells it to.
FOR_STUDENTS = sorted(set(FORMATS) - {"csv", "gradescope"})
#: Whatever is said of a hidden check has this in it.
MARK = "hush"
TIMES = re.compile(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ")


@pytest.fixture(autouse=True)
def classroom(monkeypatch):
    for name, value in samples.CLASSROOM50.items():
        monkeypatch.setenv(name, value)


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


def written(folder, *verdicts, **more):
    """A result as it lies in a graded folder, led by the hidden check, for it costs most."""
    diagnosis = {
        "diagnosis": samples.diagnosis(
            key="check",
            cause=f"The {MARK} rationale.",
            help=f"The {MARK} help.",
            check=f"{MARK}_check",
        )
    }
    folder.mkdir(exist_ok=True)
    return samples.graded(folder, drive(Spiral(), ticks=400), *verdicts, **diagnosis, **more)


def shown_in(name, path, view="student"):
    content = render(name, [read_report(path, view=view)])
    if name == "github-autograding":
        content = base64.b64decode(content).decode()
    return TIMES.sub("", content)


@pytest.mark.parametrize("visible", ["never", "after_due"])
@pytest.mark.parametrize("name", FOR_STUDENTS)
def test_no_text_of_a_hidden_check_is_in_any_report_for_students(tmp_path, name, visible):
    path = written(tmp_path / "graded", *samples.MIXED, secret(visible))
    content = shown_in(name, path)
    assert MARK not in content.lower()
    assert "17.77" not in content
    assert "31.7" in content  # what is not shown is told, by its points
    assert READERS[name](render(name, [read_report(path)])) == {"classroom50": 18}.get(name, 18.33)


@pytest.mark.parametrize("passed", [True, False], ids=["the rest passed", "the rest did not"])
@pytest.mark.parametrize("name", FOR_STUDENTS)
def test_a_report_for_students_is_the_same_whatever_came_of_hidden_checks(tmp_path, name, passed):
    others = [samples.verdict("starts")] if passed else samples.MIXED
    failed = written(tmp_path / "graded", *others, secret())
    content = shown_in(name, failed)
    made = samples.result(*others, secret(status="passed", score=31.7))
    if not passed:
        made["diagnosis"] = samples.diagnosis(key="check", cause="Other.", check="draws")
    made["artifacts"] = json.loads(failed.read_text())["artifacts"]
    failed.write_text(json.dumps(made))
    assert shown_in(name, failed) == content


@pytest.mark.parametrize("name", FOR_STUDENTS)
def test_who_passed_what_is_shown_does_not_read_that_all_passed(tmp_path, name):
    path = written(tmp_path / "graded", samples.verdict("starts"), secret())
    content = shown_in(name, path)
    assert "1 check worth 31.7 points is not shown here, nor counted in this score." in content
    assert not re.search(r"\b(all|only)\b[^.]{0,12}\bchecks?\b[^.]{0,5}passed", content, re.I)


@pytest.mark.parametrize("name", sorted(FORMATS))
def test_where_nothing_at_all_is_shown_nothing_is_earned_yet(tmp_path, name):
    path = written(tmp_path / "graded", secret())
    if name in FOR_STUDENTS:
        assert READERS[name](render(name, [read_report(path)])) == 0
        assert MARK not in shown_in(name, path)
    if name == "prairielearn":
        assert json.loads(shown_in(name, path))["score"] == 0


@pytest.mark.parametrize("name", sorted(set(FORMATS) - {"csv"}))
def test_of_points_only_every_format_shows_the_points_and_no_finding(tmp_path, name):
    path = written(tmp_path / "graded", *samples.MIXED, secret("points_only"))
    content = shown_in(name, path)
    assert f"The {MARK} title" in content.replace("\\", "") or name == "autolab"
    for words in ("rationale", "help", "note"):
        assert f"the {MARK} {words}" not in content.lower()
    assert "What was found is not shown" in content
    total = READERS[name](render(name, [read_report(path)]))
    assert total == pytest.approx({"classroom50": 215}.get(name, 21.5))


@pytest.mark.parametrize("name", sorted(set(FORMATS) - {"csv"}))
def test_a_teacher_sees_all_and_what_students_see_of_it(tmp_path, name):
    path = written(tmp_path / "graded", *samples.MIXED, secret())
    content = shown_in(name, path, "whole").replace("\\", "")
    for words in ("rationale", "note"):
        assert f"the {MARK} {words}" in content.lower()
    assert "not shown here" not in content
    if name in ("terminal", "html", "markdown"):
        assert "students never see it" in " ".join(content.split())


@pytest.mark.parametrize("name", FOR_STUDENTS)
def test_when_the_exercise_is_over_students_see_what_waited_for_that(tmp_path, name):
    path = written(tmp_path / "graded", *samples.MIXED, secret("after_due"))
    content = shown_in(name, path, "after_due").replace("\\", "")
    assert f"the {MARK} rationale" in content.lower()
    assert "not shown" not in content
    assert "students see it" not in content
    total = READERS[name](render(name, [read_report(path, view="after_due")]))
    assert total == pytest.approx({"classroom50": 215}.get(name, 21.5))


def test_gradescope_hides_by_its_own_means_and_has_all_points(tmp_path):
    others = [
        secret("after_due") | {"check": "later", "title": "Later"},
        secret("points_only", "passed", 31.7) | {"check": "part", "title": "Part"},
    ]
    path = written(tmp_path / "graded", *samples.MIXED, secret(), *others)
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
    over = json.loads(shown_in("gradescope", path, "after_due"))["tests"]
    assert [test["visibility"] for test in over].count("hidden") == 1
    whole = json.loads(shown_in("gradescope", path, "whole"))["tests"]
    assert not [test for test in whole if "visibility" in test]


def test_a_table_of_a_class_is_for_its_teacher(tmp_path):
    path = written(tmp_path / "graded", *samples.MIXED, secret())
    header, row = csv.reader(io.StringIO(shown_in("csv", path)))
    told = dict(zip(header, row, strict=True))
    assert (told["score"], told[f"{MARK}_check"]) == ("21.5", "3.17")


@pytest.mark.parametrize("name", sorted(FORMATS))
def test_where_nothing_is_hidden_everybody_reads_the_same(tmp_path, name):
    path = samples.graded(tmp_path, drive(Spiral(), ticks=400), *samples.MIXED)
    assert (
        shown_in(name, path) == shown_in(name, path, "after_due") == shown_in(name, path, "whole")
    )


def late(folder, *verdicts):
    listed = verdicts or (samples.verdict("draws", "failed", 87.5, max_score=100),)
    return samples.graded(folder, drive(Spiral(), ticks=400), *listed, handed_in=to_json(LATE))


@pytest.mark.parametrize("name", ["terminal", "html", "markdown", "prairielearn", "moodle-vpl"])
def test_what_lateness_costs_is_told(tmp_path, name):
    content = shown_in(name, late(tmp_path))
    plain = " ".join(content.replace("\\", "").split())
    assert "Handed in 1 day 3 h late: 20 points less; 67.5 instead of 87.5." in plain
    assert "Zoë Müller, attempt 2, handed in 2026-12-02 01:59:00+00:00." in plain or (
        name == "prairielearn"
    )
    if name != "prairielearn":
        assert READERS[name](content) == 67.5


def test_what_lateness_costs_does_not_tell_what_hidden_checks_gave(tmp_path):
    content = shown_in("html", late(tmp_path, *samples.MIXED, secret()))
    assert "Handed in 1 day 3 h late: 20 points less in the total of all checks." in content
    assert READERS["html"](content) == 18.33
    assert "21.5" not in content.partition("<script")[0].partition("<figure>")[0]


@pytest.mark.parametrize(
    ("hand_in", "words"),
    [
        (
            SubmissionInfo.of("4711", "", 1, DUE, POLICY),
            ["4711, attempt 1, handed in 2026-11-30 22:59:"],
        ),
        (SubmissionInfo.of("4711", "Zoë", 1, None, POLICY), ["Zoë, attempt 1."]),
        (
            SubmissionInfo("4711", "Zoë", 1, DUE, 300),
            ["Handed in 5 min late, which costs no points."],
        ),
    ],
)
def test_who_was_in_time_is_told_so(hand_in, words):
    made = Result.from_json(samples.result() | {"handed_in": to_json(hand_in)})
    report = samples.report(handed_in=to_json(hand_in))
    assert (report.score, report.deducted) == (made.score, 0)
    assert all(word in " ".join(report.notes) for word in words)


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.2, "1 s"),
        (40, "40 s"),
        (300, "5 min"),
        (7800, "2 h 10 min"),
        (97_200, "1 day 3 h"),
        (2 * 86_400 + 59, "2 days"),
    ],
)
def test_a_duration_is_told_as_people_count(seconds, words):
    assert duration(seconds) == words


def test_the_verb_shows_students_less_than_teachers(tmp_path, capsys, monkeypatch):
    path = str(written(tmp_path / "graded", *samples.MIXED, secret("after_due")))
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


def test_the_costs_of_a_policy_without_points_are_none():
    assert LatePolicy(DUE, 0, 0, 100).deduction(DUE.replace(year=2027)).points == 0
