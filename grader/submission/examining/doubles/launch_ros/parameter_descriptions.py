"""A double of ROS's `launch_ros.parameter_descriptions`, and of `launch_ros.descriptions`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import yaml
from launch._core import (
    LaunchContext,
    Substitution,
    module,
    normalize_to_list_of_substitutions,
    text_of,
    unknown,
)


class ParameterValue:
    def __init__(self, value: Any, *, value_type: Any = None) -> None:
        self._value, self._type = value, value_type

    @property
    def value(self) -> Any:
        return self._value

    @property
    def value_type(self) -> Any:
        return self._type

    @property
    def is_text(self) -> bool:
        return self._type is str

    def evaluate(self, context: LaunchContext) -> Any:
        return evaluated(context, self._value, self._type)


class Parameter(ParameterValue):
    def __init__(
        self, name: Any, value: Any, *, value_type: Any = None, description: Any = ""
    ) -> None:
        super().__init__(value, value_type=value_type)
        self.name = name


class ParameterFile:
    def __init__(self, param_file: Any, *, allow_substs: Any = False) -> None:
        self.param_file = param_file
        self.allow_substs = allow_substs


def is_substitution(value: Any) -> bool:
    """Whether a value is put through YAML when it is known."""
    if isinstance(value, Substitution):
        return True
    return isinstance(value, list | tuple) and any(isinstance(v, Substitution) for v in value)


def evaluated(context: LaunchContext, value: Any, kind: Any = None) -> Any:
    """The value of a parameter.

    Raises:
        TypeError: it is of no kind that a parameter has, or YAML does not read it.
    """
    if is_substitution(value):
        text = text_of(context, normalize_to_list_of_substitutions(value))
        return text if kind is str else _from_yaml(text, kind)
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, str) and kind not in (None, str):
        return _from_yaml(value, kind)
    if isinstance(value, list | tuple):
        made = [_of_list(context, each) for each in value]
        is_number = all(type(each) in (int, float) for each in made)
        return [*map(float, made)] if is_number and any(type(e) is float for e in made) else made
    if value is None or not isinstance(value, bool | int | float | str | bytes):
        raise TypeError(
            "Allowed value types are bytes, bool, int, float, str, Sequence[bool], Sequence[int], "
            f"Sequence[float], Sequence[str]. Got {type(value)}."
        )
    return value


def _of_list(context: LaunchContext, given: Any) -> Any:
    """The value of an entry; one in parts goes through YAML, as a substitution does."""
    if isinstance(given, list | tuple):
        return _from_yaml(text_of(context, normalize_to_list_of_substitutions(given)), None)
    return evaluated(context, given)


def _from_yaml(text: str, kind: Any) -> Any:
    try:
        value = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise TypeError(
            "Unable to parse the value of parameter as yaml. If the parameter is meant to be a "
            "string, try wrapping it in launch_ros.parameter_descriptions.ParameterValue(value, "
            "value_type=str)"
        ) from error
    if value is None:
        return text
    if isinstance(value, dict) or (kind in (bool, int, float) and not isinstance(value, kind)):
        if kind is float and isinstance(value, int):
            return float(value)
        raise TypeError(f"Unable to parse the value of parameter as yaml: found {type(value)}")
    return value


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
