"""For the verbs: something handed in, and runs that take no time."""

from dataclasses import replace

import pytest

from grader import grading
from tests.grader.driving import Spiral, drive


@pytest.fixture(scope="session")
def drawn():
    """What runs come to."""
    return drive(Spiral(), ticks=300)


@pytest.fixture
def in_no_time(monkeypatch, drawn):
    """Runs in virtual time are over at once."""
    run = lambda _, plan, __=None: replace(drawn, start=plan.start)  # noqa: E731
    monkeypatch.setitem(grading.RUNNERS, "virtual", run)


@pytest.fixture
def node(tmp_path, monkeypatch):
    """A submission in the current folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "node.py").write_text("import turtlesim.msg")
    return tmp_path / "node.py"
