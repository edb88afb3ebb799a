"""Lists of numbers in messages take what they take where nothing checks fields: ints, numpy's too.

A submission's messages check their fields (`grader.run.environment`), since a number alone of
another type goes wrong on its way into C. A list does not: it becomes an `array.array`, which
converts or refuses. Where nothing checks, `position = [0, 1]` and a numpy array are right.
"""

from __future__ import annotations

import array
from contextlib import suppress
from typing import Any, Final

_CODES: Final = {"sequence<double>": "d", "sequence<float>": "f"}


def accept_numbers(message: Any) -> None:
    """Have the lists of a type of messages converted before they are checked."""
    for field, kind in message.get_fields_and_field_types().items():
        if kind in _CODES:
            _convert(message, field, _CODES[kind])


def _convert(message: Any, field: str, code: str) -> None:
    checked = getattr(message, field)
    if hasattr(checked.fset, "__wrapped__"):
        return  # by an earlier publisher

    def converted(self: Any, value: Any) -> None:
        if not isinstance(value, array.array):
            with suppress(TypeError, ValueError, OverflowError):
                value = array.array(code, value)
        checked.fset(self, value)

    converted.__wrapped__ = checked.fset  # type: ignore[attr-defined]
    setattr(message, field, checked.setter(converted))
