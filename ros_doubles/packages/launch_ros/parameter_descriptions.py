"""A double of ROS's `launch_ros.parameter_descriptions`, and of `launch_ros.descriptions`."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from launch._core import (
    LaunchContext,
    Substitution,
    module,
    normalize_to_list_of_substitutions,
    text_of,
    unknown,
)
from launch.utilities.type_utils import (
    coerce_to_type,
    is_substitution,
    normalize_typed_substitution,
    perform_typed_substitution,
)

#: Of one type are the items of a list.
_ITEMS = (bool, int, float, str)


class ParameterValue:
    def __init__(self, value: Any, *, value_type: Any = None) -> None:
        self._value, self._type = normalize_typed_substitution(value, value_type), value_type

    @property
    def value(self) -> Any:
        return self._value

    @property
    def value_type(self) -> Any:
        return self._type

    @property
    def is_text(self) -> bool:
        is_list = isinstance(self._value, list) and not is_substitution(self._value)
        return self._type is str or is_list

    def evaluate(self, context: LaunchContext) -> Any:
        return perform_typed_substitution(context, self._value, self._type)


class Parameter(ParameterValue):
    def __init__(
        self, name: Any, value: Any, *, value_type: Any = None, description: Any = ""
    ) -> None:
        super().__init__(value, value_type=value_type)
        self.name = normalize_to_list_of_substitutions(name)


class ParameterFile:
    def __init__(self, param_file: Any, *, allow_substs: Any = False) -> None:
        if not isinstance(param_file, Path | bytes):
            param_file = normalize_to_list_of_substitutions(param_file)
        self.param_file = param_file
        self.allow_substs = normalize_typed_substitution(allow_substs, bool)

    def has_substitutions(self, context: LaunchContext) -> bool:
        return bool(perform_typed_substitution(context, self.allow_substs, bool))


def normalize_parameter_dict(given: Mapping[Any, Any], before: Any = ()) -> dict[Any, Any]:
    """Names as tuples of substitutions, with values that are known or are evaluated later.

    Raises:
        TypeError: a value is of no kind that a parameter has.
    """
    found: dict[Any, Any] = {}
    for key, value in given.items():
        name = (*before, *normalize_to_list_of_substitutions(key))
        if isinstance(value, Mapping):
            found |= normalize_parameter_dict(
                value, (*name, *normalize_to_list_of_substitutions("."))
            )
        elif isinstance(value, ParameterValue | bool | int | float | str | bytes):
            found[name] = value
        elif isinstance(value, Substitution):
            found[name] = [value]
        elif isinstance(value, Sequence):
            found[name] = _normalized_list(value)
        else:
            raise TypeError(f"Unexpected type for parameter value {value!r:.80}")
    return found


def _normalized_list(given: Sequence[Any]) -> Any:
    """Items, of which some are lists of substitutions; or one text, where it has parts of one."""
    for each in given:
        if not isinstance(each, (*_ITEMS, Substitution, Iterable)) or isinstance(each, Mapping):
            raise TypeError(f"Expected 'subvalue' to be a text or a number, but got '{each!r:.80}'")
    if is_substitution(given):
        return normalize_to_list_of_substitutions(given)
    if {type(each) for each in given} == {int, float}:
        return tuple(map(float, given))
    return tuple(
        each if isinstance(each, _ITEMS) else normalize_to_list_of_substitutions(each)
        for each in given
    )


def evaluated(context: LaunchContext, value: Any) -> Any:
    """The value of a normalized parameter.

    Raises:
        TypeError, ValueError: it is of no kind that a parameter has, or YAML does not read it.
    """
    if isinstance(value, ParameterValue):
        return value.evaluate(context)
    if isinstance(value, list):
        value = coerce_to_type(text_of(context, value))
    elif isinstance(value, tuple):  # an empty item is null, which is none
        texts = (text_of(context, each) if isinstance(each, list) else None for each in value)
        value = [
            each if text is None else coerce_to_type(text or "null")
            for each, text in zip(value, texts, strict=True)
        ]
    if isinstance(value, list):
        kinds = [type(each) for each in value[:1] if type(each) in _ITEMS]
        if not (kinds and all(isinstance(each, kinds[0]) for each in value)):
            raise TypeError(
                f"Expected a non-empty sequence, with items of one type; got {value!r:.80}"
            )
    return value


def as_word(name: str, value: Any) -> str:
    """A parameter as an argument."""
    return f"{name}:={json.dumps(value, default=str, ensure_ascii=False)}"


class ComposableNode:
    def __init__(
        self,
        *,
        package: Any,
        plugin: Any,
        name: Any = None,
        namespace: Any = None,
        parameters: Any = None,
        remappings: Any = None,
        extra_arguments: Any = None,
        condition: Any = None,
    ) -> None:
        self.package = package
        self.plugin = plugin
        self.name = name
        self.parameters = parameters


descriptions = module(
    "launch_ros.descriptions", ComposableNode, Parameter, ParameterFile, ParameterValue
)

__all__ = [
    "Parameter",
    "ParameterFile",
    "ParameterValue",
]
__getattr__ = unknown("launch_ros.parameter_descriptions")
