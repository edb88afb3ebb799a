from contextlib import ExitStack

import pytest

from tests.grader_class.find.exports import Finder


@pytest.fixture
def finder():
    with ExitStack() as stack:
        yield Finder(stack)
