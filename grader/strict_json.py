"""JSON as it is defined: without NaN and infinite numbers, which Python takes and others do not."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from typing import Any, NoReturn, TypeVar

_Number = TypeVar("_Number", int, float)


def loads(text: str) -> Any:
    """What a text in JSON says.

    Raises:
        ValueError: it is no JSON, or a number in it is none that can be computed with.
        RecursionError: it is nested too deeply.
    """
    return json.loads(
        text, parse_constant=_refuse, parse_float=_finite(float), parse_int=_finite(int)
    )


def _finite(make: Callable[[str], _Number]) -> Callable[[str], _Number]:
    def parse(text: str) -> _Number:
        if not math.isfinite(float(text)):
            _refuse(text)
        return make(text)

    return parse


def _refuse(text: str) -> NoReturn:
    raise ValueError(f"damaged, {text:.20} is no number in JSON")
