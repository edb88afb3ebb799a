"""What the documents point at is there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from grader.course.kinds import KINDS

ROOT = Path(__file__).parents[1]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])
LINK = re.compile(r"\]\((?!https?:|#)([^)#]+)")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_leads_somewhere(page):
    links = LINK.findall(page.read_text(encoding="utf-8"))
    assert [link for link in links if not (page.parent / link).exists()] == []


def test_the_readme_names_every_system_that_a_course_can_be_on():
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    assert [kind.title for kind in KINDS.values() if kind.title not in readme] == []
    table = (ROOT / "docs" / "course-ci.md").read_text(encoding="utf-8")
    assert [name for name in KINDS if f"| `{name}` |" not in table] == []


def test_every_file_on_the_way_through_the_code_is_there():
    """A path with folders stands for itself, a bare name for a file of that name."""
    text = (ROOT / "docs" / "the-way-through-the-code.md").read_text(encoding="utf-8")
    tops = [path for path in ROOT.iterdir() if path.is_dir() and not path.name.startswith(".")]
    found = {f"/{path.relative_to(ROOT)}" for top in tops for path in [top, *top.glob("**/*")]}
    for name in re.findall(r"`([\w/.]+\.py|[\w/]+/)`", text):
        assert any(path.endswith(f"/{name.rstrip('/')}") for path in found), name
