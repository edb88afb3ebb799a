"""A double of ROS's `launch.utilities` and its `type_utils`: texts and substitutions with a type.

A kind is `str`, `bool`, `int`, `float`, `List[...]` of these, or None: what YAML makes of a text.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, get_args

import yaml
from launch._core import (
    LaunchContext,
    Substitution,
    module,
    normalize_to_list_of_substitutions,
    perform_substitutions,
    unknown,
)

SCALARS = (int, float, bool, str)


def is_substitution(value: Any) -> bool:
    """Whether a value becomes a text: a substitution, or a list of texts with one."""
    parts = value if isinstance(value, list | tuple) else [value]
    is_part = [isinstance(each, Substitution) for each in parts]
    return any(is_part) and all(isinstance(each, Substitution | str) for each in parts)


def is_instance_of(value: Any, kind: Any, *, can_be_str: bool = False) -> bool:
    """Whether a value is of a kind; of None are scalars, and lists of one type of them."""
    texts = (str,) if can_be_str else ()
    if kind is None:
        if not isinstance(value, list):
            return isinstance(value, SCALARS)
        of = next((type(each) for each in value if type(each) is not str), str)
        return of in SCALARS and all(isinstance(each, (of, *texts)) for each in value)
    if found := get_args(kind):
        return isinstance(value, list) and all(isinstance(e, (found[0], *texts)) for e in value)
    return isinstance(value, (kind, *texts))


def coerce_to_type(text: str, kind: Any = None, *, can_be_str: bool = False) -> Any:
    """The value of a text.

    Raises:
        ValueError: it has none of this kind.
    """
    if kind is str:
        return text
    if kind in (int, float):
        try:
            return kind(text)
        except ValueError:
            if can_be_str:
                return text
            raise
    if kind is bool:
        text = {"1": "true", "0": "false"}.get(text, text)
    value = _from_yaml(text, can_be_str=can_be_str)
    if not is_instance_of(value, kind, can_be_str=can_be_str):
        of = "using yaml rules" if kind is None else f"to {getattr(kind, '__name__', kind)}"
        raise ValueError(f"Failed to convert '{text[:80]}' {of}: found {type(value).__name__}")
    return value


def _from_yaml(text: str, *, can_be_str: bool) -> Any:
    try:
        return yaml.safe_load(text) if text else text
    except yaml.YAMLError as error:
        if can_be_str:
            return text
        raise ValueError(
            "Unable to parse the value of parameter as yaml. If the parameter is meant to be a "
            "string, try wrapping it in launch_ros.parameter_descriptions.ParameterValue(value, "
            "value_type=str)"
        ) from error


def normalize_typed_substitution(value: Any, kind: Any = None) -> Any:
    """A scalar, a list of substitutions that are one text, or a list of either.

    Raises:
        TypeError: it cannot be of this kind.
    """
    if isinstance(value, SCALARS):
        if not (kind is None or is_instance_of(value, kind)):
            raise TypeError(f"value='{value}' is not an instance of {kind}")
        return value
    if is_substitution(value):
        return normalize_to_list_of_substitutions(value)
    if not isinstance(value, Iterable) or (kind is not None and not get_args(kind)):
        raise TypeError(f"value should be {kind or 'a scalar, or a list'}, found {value!r:.80}")
    found = [normalize_to_list_of_substitutions(e) if is_substitution(e) else e for e in value]
    types = {type(each) for each in value if not is_substitution(each)}
    if types == {int, float}:
        found, types = [float(e) if type(e) is int else e for e in found], {float}
    of = get_args(kind) or SCALARS
    if len(types) > 1 or not types <= {*of} or (not found and str not in of):
        raise TypeError(f"expected a list of one type, found {value!r:.80}")
    return found


def perform_typed_substitution(context: LaunchContext, value: Any, kind: Any = None) -> Any:
    """What a normalized value is.

    Raises:
        ValueError: a text cannot be converted, or a list is of several types.
    """
    if isinstance(value, SCALARS):
        return value
    if is_substitution(value):
        return coerce_to_type(perform_substitutions(context, value), kind)
    of = next(iter(get_args(kind)), None)
    found = [
        coerce_to_type(perform_substitutions(context, e), of) if isinstance(e, list) else e
        for e in value
    ]
    if not is_instance_of(found, kind):
        raise ValueError(f"The output list is not uniform: {found!r:.80}")
    return found


type_utils = module(
    "launch.utilities.type_utils",
    *(coerce_to_type, is_instance_of, is_substitution),
    *(normalize_typed_substitution, perform_typed_substitution),
)
__all__ = ["normalize_to_list_of_substitutions", "perform_substitutions"]
__getattr__ = unknown("launch.utilities")
