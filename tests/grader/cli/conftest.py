from dataclasses import replace

import pytest

from grader import grading
from tests.grader.driving import Spiral, drive


@pytest.fixture(scope="session")
def drawn():
    return drive(Spiral(), ticks=300)


@pytest.fixture
def in_no_time(monkeypatch, drawn):
    run = lambda _, plan, __=None: replace(drawn, start=plan.start)  # noqa: E731
    monkeypatch.setitem(grading.RUNNERS, "virtual", run)


@pytest.fixture
def node(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "node.py").write_text("import turtlesim.msg")
    return tmp_path / "node.py"
