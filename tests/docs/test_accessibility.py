"""docs/accessibility.md: complete, and every pointer leads to a test."""

from __future__ import annotations

import ast
import re
from functools import cache

from tests.once import ROOT

TEXT = (ROOT / "docs" / "accessibility.md").read_text(encoding="utf-8")
#: The success criteria of WCAG 2.2, with the one that it has removed, in the order of the template.
CRITERIA = {
    "A": "1.1.1 1.2.1 1.2.2 1.2.3 1.3.1 1.3.2 1.3.3 1.4.1 1.4.2 2.1.1 2.1.2 2.1.4 2.2.1 2.2.2 "
    "2.3.1 2.4.1 2.4.2 2.4.3 2.4.4 2.5.1 2.5.2 2.5.3 2.5.4 3.1.1 3.2.1 3.2.2 3.2.6 3.3.1 3.3.2 "
    "3.3.7 4.1.1 4.1.2",
    "AA": "1.2.4 1.2.5 1.3.4 1.3.5 1.4.3 1.4.4 1.4.5 1.4.10 1.4.11 1.4.12 1.4.13 2.4.5 2.4.6 2.4.7 "
    "2.4.11 2.5.7 2.5.8 3.1.2 3.2.3 3.2.4 3.3.3 3.3.4 3.3.8 4.1.3",
}
LEVELS = {"Supports", "Partially Supports", "Does Not Support", "Not Applicable"}
POINTER = re.compile(r"`(tests/[\w/]+\.py)::(\w+)`")


def rows(level: str) -> list[list[str]]:
    part = TEXT.split(f"Success Criteria, Level {level}\n")[1].split("\n## ")[0]
    lines = [line for line in part.splitlines() if line.startswith("| ")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[1:]]


@cache
def names_in(file: str) -> set[str]:
    parsed = ast.parse((ROOT / file).read_bytes())
    return {node.name for node in ast.walk(parsed) if isinstance(node, ast.FunctionDef)}


def test_every_criterion_has_its_line_and_a_level_of_the_template():
    for level, criteria in CRITERIA.items():
        assert [name.split()[0] for name, _, _ in rows(level)] == criteria.split()
        assert {conformance for _, conformance, _ in rows(level)} <= LEVELS


def test_every_line_says_what_holds_it():
    listed = set(re.findall(r"^\| (T\d+) \|", TEXT, re.MULTILINE))
    used = set[str]()
    for name, conformance, remark in rows("A") + rows("AA"):
        held = set(re.findall(r"\bT\d+", remark))
        assert held <= listed, name
        assert held or "No test: " in remark or conformance == "Not Applicable", name
        used |= held
    assert listed - used <= {f"T{n}" for n in (3, 4, 6, 32)}  # of a span, or of what stands beside


def test_every_pointer_leads_to_a_test():
    for page in [*(ROOT / "docs").glob("*.md"), *ROOT.glob("*.md")]:
        for file, name in POINTER.findall(page.read_text(encoding="utf-8")):
            assert name in names_in(file), f"{page.name}: {file}::{name}"
    assert len(POINTER.findall(TEXT)) > 30
