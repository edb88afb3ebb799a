from xml.etree import ElementTree

from grader.reports import read as read_report
from grader_class.reports import junit
from tests.grader.driving import Spiral, drive
from tests.grader.reports import readers, samples
from tests.grader.reports.samples import verdict


def cases(report):
    content = junit.render(report)
    readers.junit(content)
    return ElementTree.fromstring(content).findall(".//testcase")


def test_passed_failed_and_not_judged_are_told_apart():
    kinds = [[child.tag for child in case] for case in cases(samples.report())]
    out = "system-out"
    assert kinds == [[out], ["failure", out], ["failure", out], ["skipped", out]]


def test_marks_of_xml_come_out_as_they_went_in():
    text = "]]> <![CDATA[ &amp; <failure/> \"'"
    (case,) = cases(samples.report(verdict("x", "failed", 0, rationale=text)))
    assert case.find("failure").get("message") == text
    assert case.findtext("failure").splitlines()[0] == text


def test_the_picture_is_attached_to_what_failed_if_it_lies_in_the_project(tmp_path, monkeypatch):
    path = samples.graded(tmp_path / "graded", drive(Spiral(), ticks=200))
    monkeypatch.chdir(tmp_path)
    said = [case.findtext("system-out") for case in cases(read_report(path))]
    attached = ["[[ATTACHMENT|graded/canvas.png]]" in text for text in said]
    assert attached == [False, True, True, False]
    monkeypatch.chdir(tmp_path / "graded" / "recording")
    assert "ATTACHMENT" not in junit.render(read_report(path))


def test_a_submission_attaches_nothing():
    text = "[[ATTACHMENT|/etc/passwd]]"
    (case,) = cases(samples.report(verdict("x", rationale=text)))
    assert "[[" not in case.findtext("system-out")
