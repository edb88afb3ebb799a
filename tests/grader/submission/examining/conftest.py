"""Each test is a look of its own: what the children of others took is none of its account."""

import pytest

from grader.submission.examining import steps


@pytest.fixture(autouse=True)
def account():
    steps.open_account()
