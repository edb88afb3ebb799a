"""For all tests of finding."""

from tests.grader.batch.find.exports import finder

__all__ = ["finder"]
