"""Classroom 50's format is made in its environment alone."""

from tests.grader.reports.conftest import classroom as classroom
