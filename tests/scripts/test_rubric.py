"""The page about all checks is made of the checks."""

from __future__ import annotations

import runpy
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_the_page_in_the_docs_is_the_one_that_the_checks_make():
    page = runpy.run_path(str(ROOT / "scripts" / "rubric.py"))["page"]
    shown = (ROOT / "docs" / "rubric.md").read_text(encoding="utf-8")
    assert shown == page(shown), "run python scripts/rubric.py"
