"""For tests that speak: afterwards this process speaks English again."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from grader.translations import ENGLISH, use


@pytest.fixture(autouse=True)
def english_again() -> Iterator[None]:
    yield
    use(ENGLISH)
