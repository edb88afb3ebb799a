"""JUnit XML, for GitLab, Jenkins and GitHub actions. Not judged is `skipped`, never a pass."""

from __future__ import annotations

from pathlib import Path
from typing import Final
from xml.etree import ElementTree

from grader import Verdict
from grader.reports import ErrorReport, Format, Report
from grader.reports.wording import score_text, word
from grader.text import msg, number, one_line, plain, tr, translate
from grader_class.reports.lines import led_lines


def render(report: Report) -> str:
    """Return the XML document, with points in the suite's properties and each system-out."""
    properties = {
        "submission": report.submission,
        "score": str(number(report.score)),
        "max_score": str(number(report.max_score)),
        "outcome": report.run.outcome,
    }
    if report.diagnosis is not None:
        properties["diagnosis"] = report.headline
    cases = [_case(report, verdict) for verdict in report.verdicts]
    if report.deducted:
        properties["deducted"] = str(number(report.deducted))
    if report.not_shown:
        properties["not_shown"] = report.not_shown
        # a skipped case of all hidden checks: else all would seem to pass
        cases.append(_testcase(report.exercise, report.not_shown_name))
        ElementTree.SubElement(cases[-1], "skipped", {"message": report.not_shown})
    return _document(report.exercise, max(report.run.wall_s, 0), properties, cases)


def render_error(report: ErrorReport) -> str:
    """Return the XML document: its only case fails, or is an error where nothing was judged."""
    properties = {"whose": str(report.whose)}
    if report.is_judged:
        properties["score"] = "0"
    if report.max_score is not None:
        properties["max_score"] = str(number(report.max_score))
    case = _testcase("grader", report.title)
    attributes = {"message": one_line(report.message), "type": report.whose}
    kind = "failure" if report.is_judged else "error"
    ElementTree.SubElement(case, kind, attributes).text = "\n\n".join(report.paragraphs)
    return _document("grader", 0, properties, [case])


def _document(
    name: str, time_s: float, properties: dict[str, str], cases: list[ElementTree.Element]
) -> str:
    kinds = [child.tag for case in cases for child in case]
    counts = {
        "tests": str(len(cases)),
        "failures": str(kinds.count("failure")),
        "errors": str(kinds.count("error")),
        "skipped": str(kinds.count("skipped")),
        "time": f"{time_s:.3f}",
    }
    root = ElementTree.Element("testsuites", counts)
    suite = ElementTree.SubElement(root, "testsuite", {"name": name, **counts})
    listed = ElementTree.SubElement(suite, "properties")
    for key, value in properties.items():
        ElementTree.SubElement(listed, "property", {"name": key, "value": value})
    suite.extend(cases)
    ElementTree.indent(root)
    body = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{body}\n'


def _testcase(suite: str, name: str) -> ElementTree.Element:
    # GitLab shows the class as the suite.
    return ElementTree.Element("testcase", {"classname": suite, "name": name, "time": "0"})


def _case(report: Report, verdict: Verdict) -> ElementTree.Element:
    case = _testcase(report.exercise, f"{verdict.check}: {translate(verdict.title)}")
    lines = led_lines(report, verdict)
    message = {"message": one_line(lines[0] if lines else "")}
    if verdict.status == "failed":
        failure = ElementTree.SubElement(case, "failure", {**message, "type": "failed"})
        failure.text = "\n".join(lines)
    elif verdict.status == "not_judged":
        ElementTree.SubElement(case, "skipped", message)
    output = [tr("{word}, {score} points", word=word(verdict), score=score_text(verdict))]
    if verdict.status != "failed":
        output += [line.replace("[[", "[ [") for line in lines]  # so that it attaches no file
    elif attachment := _canvas_here(report):
        output.append(f"[[ATTACHMENT|{attachment}]]")
    ElementTree.SubElement(case, "system-out").text = "\n".join(output)
    return case


def _canvas_here(report: Report) -> str:
    """Return the picture's path relative to the project, for GitLab; '' where it has none."""
    path = report.artifacts.canvas_path
    if path is None or not path.is_relative_to(Path.cwd()):
        return ""
    name = path.relative_to(Path.cwd()).as_posix()
    return name if name == plain(name) and "]]" not in name else ""


FORMAT: Final = Format(
    msg("JUnit XML for GitLab, Jenkins and GitHub actions"), render, render_error
)
