"""What the documents point at is there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])
LINK = re.compile(r"\]\((?!https?:|#)([^)#]+)")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_every_link_leads_somewhere(page):
    links = LINK.findall(page.read_text(encoding="utf-8"))
    assert [link for link in links if not (page.parent / link).exists()] == []


def test_every_file_on_the_way_through_the_code_is_there():
    """A path with folders stands for itself, a bare name for a file of that name."""
    text = (ROOT / "docs" / "the-way-through-the-code.md").read_text(encoding="utf-8")
    files = {path.name for path in ROOT.glob("*/**/*.py") if ".venv" not in path.parts}
    folders = [path for path in ROOT.glob("*/**") if path.is_dir()]
    for name in re.findall(r"`([\w/.]+\.py|[\w/]+/)`", text):
        if name.endswith("/"):
            assert any(f"{path}/".endswith(f"/{name}") for path in folders), name
        elif "/" in name:
            assert any(str(path).endswith(f"/{name}") for path in ROOT.glob("*/**/*.py")), name
        else:
            assert name in files, name
