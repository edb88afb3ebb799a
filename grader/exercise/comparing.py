"""Compares what was sent with what was expected: numbers with a tolerance, texts, lists, fields."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from typing import Any, Final

from grader.text.message import Message, msg
from grader.text.strings import without_controls

#: How far a number may be off where nothing else is said: so much of itself, and so much.
RELATIVE, ABSOLUTE = 1e-3, 1e-6
#: The keys of a range of numbers.
RANGE: Final = frozenset({"at_least", "at_most"})
#: The longest value in a sentence, and the longest text that a pattern may fit [characters].
SHOWN: Final = 60
LONGEST_MATCHED: Final = 2_000


def differences(
    found: Any, expected: Any, tolerance: float | None = None, path: str = ""
) -> Iterator[tuple[str, Any, Message]]:
    """Yield where values differ: the path of the field, what was found, and what was expected.

    Args:
        expected: with expressions and patterns filled in; `{at_least: 1, at_most: 2}` is a range,
            of a number or of each in a list. Fields that it does not name may be anything.
        tolerance: how far numbers may be off; None for `RELATIVE`.
    """
    has_range = is_range(expected)
    is_value = has_range or not isinstance(expected, Mapping)
    if isinstance(found, Mapping) and len(found) == 1 and is_value:
        ((path, found),) = found.items()  # a message's only field
    if has_range:
        low, high = expected.get("at_least", -math.inf), expected.get("at_most", math.inf)
        for place, each in enumerate(found) if isinstance(found, list) else [(-1, found)]:
            if not all(map(is_number, (low, each, high))) or not low <= each <= high:
                yield (path if place < 0 else f"{path}[{place}]"), each, _range(low, high)
    elif isinstance(expected, Mapping):
        for key, inner in expected.items():
            here = f"{path}.{key}" if path else str(key)
            if not isinstance(found, Mapping) or key not in found:
                yield here, None, msg("a field {name}", name=str(key))
            else:
                yield from differences(found[key], inner, tolerance, here)
    elif isinstance(expected, list):
        if not isinstance(found, list) or len(found) != len(expected):
            number = len(found) if isinstance(found, list) else 0
            what = msg("{n} values: {values}", n=len(expected), values=shown(expected))
            yield path, found if number < 8 else f"{number} values", what
            return
        for n, inner in enumerate(expected):
            yield from differences(found[n], inner, tolerance, f"{path}[{n}]")
    elif is_number(expected) and is_number(found):
        if not _is_near(found, expected, tolerance):
            yield path, found, msg("{value}", value=shown(expected))
    elif isinstance(expected, re.Pattern):
        is_text = isinstance(found, str) and len(found) <= LONGEST_MATCHED
        if not is_text or not expected.search(found):
            yield path, found, msg("what {pattern} fits", pattern=f"/{expected.pattern}/")
    elif isinstance(expected, float) and not math.isfinite(expected) and found == str(expected):
        return  # as JSON has it
    elif found != expected or isinstance(found, bool) != isinstance(expected, bool):
        yield path, found, msg("{value}", value=shown(expected))


def shown(value: Any) -> str:
    """Return a value as a sentence has it, not too long."""
    text = f"{value:.6g}" if isinstance(value, float) else repr(value)
    if isinstance(value, re.Pattern):
        text = f"/{without_controls(value.pattern, '?')}/"
    return text if len(text) <= SHOWN else f"{text[: SHOWN - 4]} ..."


def _is_near(found: float, expected: float, tolerance: float | None) -> bool:
    if found == expected or (math.isnan(found) and math.isnan(expected)):
        return True
    if not math.isfinite(found) or not math.isfinite(expected):
        return False
    if tolerance is None and isinstance(expected, int) and isinstance(found, int):
        return False
    slack = max(RELATIVE * abs(expected), ABSOLUTE) if tolerance is None else tolerance
    return abs(found - expected) <= slack


def is_range(value: Any) -> bool:
    """Whether an expected value is a range of numbers."""
    return isinstance(value, Mapping) and set() < value.keys() <= RANGE


def is_number(value: Any) -> bool:
    """Whether a value is a number, which true and false are not."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _range(low: Any, high: Any) -> Message:
    if high == math.inf:
        return msg("at least {low}", low=shown(low))
    if low == -math.inf:
        return msg("at most {high}", high=shown(high))
    return msg("{low} to {high}", low=shown(low), high=shown(high))
