"""Errors in every format: 0 points if the submission is to blame, no score otherwise."""

import base64
import csv
import io
import json
import re
from pathlib import Path
from xml.etree import ElementTree

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st
from markdown_it import MarkdownIt

from grader.errors import UsageError
from grader.exercise.result.json_file import ErrorResult
from grader.reports import ErrorReport, read, render
from tests.grader.reports import readers, samples
from tests.grader.reports.samples import FORMATS
from tests.grader_class.reports.test_every_format import TEXTS, safe_to_print

CHECKS = ("moves", "spiral")
#: Formats in which the absence of a judgement can be said.
CAN_SAY = sorted(set(FORMATS) - {"autolab", "classroom50"})


def error(whose="submission", message="Hand in a .py file.", max_score=100, file="x"):
    path = Path("/nowhere") / file / "error.json"
    return ErrorReport(ErrorResult(whose, message, max_score), path.parent, CHECKS, path)


# How a course system would read them: the score, or None


def terminal(content):
    last = content.rstrip().splitlines()[-1]
    return float(last.split()[1]) if re.fullmatch(r"Score: 0( of [\d.]+)?", last) else None


def html(content):
    page = readers.balanced(content)
    assert page.loads == page.anchors == []
    assert "script" not in {tag for tag, _ in page.tags}
    values = [attrs["value"] for tag, attrs in page.tags if tag == "data"]
    return float(values[0] or "nan") if values else None


def markdown(content):
    tokens = MarkdownIt("gfm-like", {"linkify": False}).parse(content)
    inline = [child for token in tokens for child in token.children or []]
    assert {child.type for child in inline} <= {"text", "hardbreak", "text_special"}
    assert {t.type for t in tokens} <= {
        *("heading_open", "heading_close", "inline", "paragraph_open", "paragraph_close"),
    }
    first = next(token for token in tokens if token.type == "inline").content
    return float(first.rsplit(": ", 1)[1].split()[0]) if ": " in first else None


def csv_table(content):
    header, row = list(csv.reader(io.StringIO(content), strict=True))
    assert len(header) == len(row)
    assert not [cell for cell in row if cell.startswith(("=", "@", "+", "-", "\t", "\r"))]
    score = dict(zip(header, row, strict=True))["score"]
    return float(score) if score else None


def junit(content):
    readers.junit_schema().validate(content)
    (suite,) = ElementTree.fromstring(content)
    properties = {p.get("name"): p.get("value") for p in suite.iter("property")}
    assert int(suite.get("failures", "")) == len(list(suite.iter("failure")))
    assert int(suite.get("errors", "")) == len(list(suite.iter("error")))
    (case,) = suite.iter("testcase")
    assert [child.tag for child in case] == ["failure" if "score" in properties else "error"]
    return float(properties["score"]) if "score" in properties else None


def gradescope(content):
    document = readers.strict_json(content)
    jsonschema.validate(document, readers.schema("gradescope"))
    assert ("score" in document) != (document.get("extra_data") == {"grader_failed": True})
    return document.get("score")


def prairielearn(content):
    document = readers.strict_json(content)
    jsonschema.validate(document, readers.schema("prairielearn"))
    assert document["gradable"] is False
    return document["score"] if "Mend that" in document["format_errors"] else None


def moodle_vpl(content):
    lines = content.splitlines()
    assert lines[0] == "<|--"
    assert lines.count("--|>") == 1
    after = lines[lines.index("--|>") + 1 :]
    assert content.count(":=>>") == len(after)
    return float(after[0].removeprefix("Grade :=>> ")) if after else None


def github_autograding(content):
    document = readers.strict_json(base64.b64decode(content.strip(), validate=True).decode())
    jsonschema.validate(document, readers.schema("github_autograding"))
    return 0 if document["status"] == "fail" else None


READERS = {
    "terminal": terminal,
    "html": html,
    "markdown": markdown,
    "csv": csv_table,
    "junit": junit,
    "gradescope": gradescope,
    "classroom50": readers.classroom50,
    "prairielearn": prairielearn,
    "autolab": readers.autolab,
    "moodle-vpl": moodle_vpl,
    "github-autograding": github_autograding,
}


@pytest.mark.parametrize("name", FORMATS)
def test_a_submission_that_cannot_be_used_has_no_points_and_is_told_why(name):
    for points in (100, None):  # they need not be known
        assert READERS[name](render(name, [error(max_score=points)])) == 0
    assert "Hand in a .py file." in samples.read_by_people(name, error())


@pytest.mark.parametrize("whose", ["exercise", "call", "grader"])
def test_whatever_else_went_wrong_is_no_judgement(whose):
    report = error(whose, "It broke.")
    for name in CAN_SAY:
        assert READERS[name](render(name, [report])) is None, name
        assert "It broke." in samples.read_by_people(name, report), name
        assert name == "csv" or "This is not your fault" in samples.read_by_people(name, report)


@pytest.mark.parametrize("name", ["autolab", "classroom50"])
def test_a_format_that_cannot_say_so_is_refused(name):
    with pytest.raises(UsageError, match=r"cannot say that nothing was judged.*: It broke\."):
        render(name, [error("grader", "It broke.")])


@given(
    whose=st.sampled_from(["submission", "exercise", "call", "grader"]),
    message=st.lists(TEXTS, max_size=3).map("\n".join),
    most=st.sampled_from([None, 0, 2.5, 100]),
    file=st.text(st.characters(codec=None, exclude_characters="\0/"), min_size=1),
)
def test_whatever_the_text_every_format_is_well_formed_and_safe_to_print(
    whose, message, most, file
):
    for name in FORMATS if whose == "submission" else CAN_SAY:
        content = render(name, [error(whose, message, most, file)])
        assert safe_to_print(content), name
        assert READERS[name](content) == (0 if whose == "submission" else None), name


def test_autolab_needs_to_know_the_problems():
    _, last = render("autolab", [error()]).splitlines()
    assert json.loads(last) == {"scores": {"moves": 0, "spiral": 0}}
    with pytest.raises(UsageError, match="add --exercise NAME"):
        render("autolab", [ErrorReport(ErrorResult("submission", "x", 1), Path())])


def test_results_and_errors_share_a_table():
    content = render("csv", [samples.report(), error(), error("grader", "=1+1")])
    rows = list(csv.DictReader(io.StringIO(content), strict=True))
    assert [row["score"] for row in rows] == ["18.33", "0", ""]
    assert [row["max_score"] for row in rows] == ["40", "100", "100"]
    assert [row["outcome"] for row in rows] == ["finished", "cannot be graded", "not graded"]
    assert rows[2]["first_to_mend"] == "'=1+1"
    assert rows[1]["draws"] == ""


def test_points_are_whole_for_classroom_50():
    document = json.loads(render("classroom50", [error(max_score=2.5)]))
    assert (document["score"], document["max-score"]) == (0, 3)
    assert "Mend that" in document["tests"][0]["message"]


def test_a_file_is_read_as_what_it_is(tmp_path):
    path = tmp_path / "x.json"
    path.write_text(json.dumps(ErrorResult("call", "\x1b[31mx", None).to_json()))
    found = read(path, CHECKS)
    assert isinstance(found, ErrorReport)
    assert (found.message, found.folder, found.checks) == ("x", tmp_path, CHECKS)
    path.write_text(json.dumps({"schema": "turtlesim-grader/error/v1"}))
    with pytest.raises(UsageError, match=r"x\.json is no error of"):
        read(path)
    for text in ("[]", '{"score": 100}'):
        path.write_text(text)
        with pytest.raises(UsageError, match=r"x\.json is no result of"):
            read(path)
