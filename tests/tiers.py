"""What of a parametrized test is for `make test-all` only."""

from collections.abc import Iterable
from typing import Any

import pytest


def others_are_more(reason: str, values: Iterable[Any], *kept: Any) -> list[Any]:
    """The parameters of a test of which `make test` runs those `kept`, and says why not the rest.

    Args:
        reason: why those that are kept stand for the others.
        values: all of them; of several arguments as tuples, whose first is what is kept.
    """
    more = pytest.mark.more(reason)
    told = [each if isinstance(each, tuple) else (each,) for each in values]
    assert set(kept) <= {first for first, *_ in told}, f"{kept}: not among {told}"
    return [pytest.param(*each, marks=() if each[0] in kept else more) for each in told]
