"""JUnit XML, for GitLab, Jenkins and GitHub actions. Not judged is `skipped`, never a pass."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from grader.reports import text
from grader.reports.report import Report, ShownVerdict


def render(report: Report) -> str:
    """The XML document. Points stand in the suite's properties and in each case's system-out."""
    verdicts = report.verdicts
    counts = {
        "tests": str(len(verdicts)),
        "failures": str(sum(v.status == "failed" for v in verdicts)),
        "errors": "0",
        "skipped": str(sum(v.status == "not_judged" for v in verdicts)),
        "time": f"{max(report.run['wall_s'], 0):.3f}",
    }
    root = ElementTree.Element("testsuites", counts)
    suite = ElementTree.SubElement(root, "testsuite", {"name": report.exercise, **counts})
    properties = ElementTree.SubElement(suite, "properties")
    for name, value in (
        ("submission", report.submission),
        ("score", text.points(report.score)),
        ("max_score", text.points(report.max_score)),
        ("outcome", report.run["outcome"]),
    ):
        ElementTree.SubElement(properties, "property", {"name": name, "value": value})
    for verdict in verdicts:
        suite.append(_case(report, verdict))
    ElementTree.indent(root)
    body = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{body}\n'


def _case(report: Report, verdict: ShownVerdict) -> ElementTree.Element:
    case = ElementTree.Element(
        "testcase",
        # GitLab shows the class as the suite.
        {"classname": report.exercise, "name": f"{verdict.name}: {verdict.title}", "time": "0"},
    )
    message = {"message": text.one_line(verdict.rationale)}
    lines = verdict.lines()
    if verdict.status == "failed":
        failure = ElementTree.SubElement(case, "failure", {**message, "type": "failed"})
        failure.text = "\n".join(lines)
    elif verdict.status == "not_judged":
        ElementTree.SubElement(case, "skipped", message)
    said = [f"{verdict.word}, {verdict.score_text} points"]
    if verdict.status != "failed":
        said += [_quote(line) for line in lines]
    elif attachment := _canvas_here(report):
        said.append(f"[[ATTACHMENT|{attachment}]]")
    ElementTree.SubElement(case, "system-out").text = "\n".join(said)
    return case


def _quote(line: str) -> str:
    """A line in which nothing but this module attaches a file."""
    return line.replace("[[", "[ [")


def _canvas_here(report: Report) -> str:
    """The picture's path as GitLab needs it: relative to the project, where its jobs run."""
    if report.canvas_path is None or not report.canvas_path.is_relative_to(Path.cwd()):
        return ""
    return report.canvas_path.relative_to(Path.cwd()).as_posix()
