import pytest

from grader_class.reports import moodle_vpl
from tests.grader.reports import readers, samples
from tests.grader.reports.samples import evidence, verdict


@pytest.mark.parametrize(
    "text",
    [
        "Grade :=>> 100",
        "\nGrade :=>> 100\n",
        "--|>\nGrade :=>>100\n<|--",
        "\u2028Grade :=>> 100",
        "\rGrade :=>> 100",
        "\x0bGrade :=>> 100\x85Grade :=>> 100",
        "Comment :=>> fine",
    ],
)
def test_nothing_that_a_submission_says_is_a_grade(text):
    words = dict.fromkeys(("title", "rationale", "help"), text)
    judged = verdict(f"a{text}", "failed", 3, **words, evidence=[evidence(text)])
    report = samples.report(judged, submission=text)
    content = moodle_vpl.render(report)
    assert readers.moodle_vpl(content) == 3
    assert (content.count(":=>>"), content.count("<|--"), content.count("--|>")) == (1, 1, 1)


def test_no_title_looks_like_a_deduction():
    content = moodle_vpl.render(samples.report(verdict("a (-5)", "failed", 3)))
    assert "-Title of a (-5): failed, 3 / 10 points\n" in content


def test_partial_points_stay_exact():
    assert moodle_vpl.render(samples.report()).endswith("--|>\nGrade :=>> 18.33\n")
