"""Each test is a look of its own, as in tests/grader/submission/examining."""

from tests.grader.submission.examining.conftest import account

__all__ = ["account"]
