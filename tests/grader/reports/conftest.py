"""Classroom 50's format is made in its environment alone."""

import pytest

from tests.grader.reports import samples


@pytest.fixture(autouse=True)
def classroom(monkeypatch):
    for name, value in samples.CLASSROOM50.items():
        monkeypatch.setenv(name, value)
