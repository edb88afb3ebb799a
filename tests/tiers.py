"""What of a parametrized test is for `make test-all` only, or for some systems."""

from collections.abc import Iterable, Mapping
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


def that_apply(reason: str, values: Mapping[Any, bool]) -> list[Any]:
    """The parameters of a test, of which those are left out that are nothing to this system."""
    return [
        pytest.param(each, marks=pytest.mark.applies(is_there, reason=reason))
        for each, is_there in values.items()
    ]
