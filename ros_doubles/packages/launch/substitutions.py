"""A double of ROS's `launch.substitutions`."""

from __future__ import annotations

import os
import shlex
import shutil
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from launch._core import (
    LaunchContext,
    Substitution,
    TextSubstitution,
    evaluate_condition_expression,
    exported,
    normalize_to_list_of_substitutions,
    text_of,
    unknown,
)


class SubstitutionFailure(RuntimeError):
    pass


class LaunchConfiguration(Substitution):
    def __init__(self, variable_name: Any, *, default: Any = None) -> None:
        self._name = normalize_to_list_of_substitutions(variable_name)
        self._default = None if default is None else _normalize_default(default)

    @property
    def variable_name(self) -> list[Substitution]:
        return self._name

    def perform(self, context: LaunchContext) -> str:
        name = text_of(context, self._name)
        if name in context.launch_configurations:
            return str(context.launch_configurations[name])
        if self._default is None:
            raise SubstitutionFailure(f"launch configuration '{name}' does not exist")
        return text_of(context, self._default)


def _normalize_default(default: Any) -> list[Substitution]:
    if isinstance(default, str | Path | Substitution):
        return normalize_to_list_of_substitutions(default)
    if isinstance(default, Iterable):
        return normalize_to_list_of_substitutions([_text(each) for each in default])
    return [TextSubstitution(text=str(default))]


def _text(value: Any) -> Any:
    return value if isinstance(value, str | Path | Substitution) else str(value)


class Command(Substitution):
    def __init__(self, command: Any, *, on_stderr: Any = "fail") -> None:
        self._command = normalize_to_list_of_substitutions(command)
        self._on_stderr = normalize_to_list_of_substitutions(on_stderr)

    def perform(self, context: LaunchContext) -> str:
        words = shlex.split(text_of(context, self._command))
        return context.record.command(words, text_of(context, self._on_stderr))


class FileContent(Substitution):
    def __init__(self, path: Any) -> None:
        self._path = normalize_to_list_of_substitutions(path)

    def perform(self, context: LaunchContext) -> str:
        path = text_of(context, self._path)
        try:
            return Path(context.record.path(path)).read_text(encoding="utf-8")
        except OSError as error:
            raise SubstitutionFailure(f"Failed to open file: {path}") from error


#: What is there wherever ROS is.
_OF_ROS = ("ros2", "python3")


class FindExecutable(Substitution):
    def __init__(self, *, name: Any) -> None:
        self._name = normalize_to_list_of_substitutions(name)

    def perform(self, context: LaunchContext) -> str:
        name = text_of(context, self._name)
        found = shutil.which(name) or (name if name in _OF_ROS else None)
        if found is None:
            raise SubstitutionFailure(f"executable '{name}' not found on the PATH")
        return found


class PathJoinSubstitution(Substitution):
    def __init__(self, substitutions: Any) -> None:
        if isinstance(substitutions, str | Substitution):
            substitutions = [substitutions]
        self._parts = [normalize_to_list_of_substitutions(each) for each in substitutions]

    @property
    def substitutions(self) -> Any:
        return self._parts

    def perform(self, context: LaunchContext) -> str:
        return os.path.join(*(text_of(context, part) for part in self._parts))


class StringJoinSubstitution(Substitution):
    def __init__(self, substitutions: Any, delimiter: Any = "") -> None:
        self._parts = [normalize_to_list_of_substitutions(each) for each in substitutions]
        self._delimiter = delimiter

    def perform(self, context: LaunchContext) -> str:
        return text_of(context, self._delimiter).join(text_of(context, p) for p in self._parts)


class EnvironmentVariable(Substitution):
    def __init__(self, name: Any, *, default_value: Any = None) -> None:
        self._name = normalize_to_list_of_substitutions(name)
        self._default = default_value

    def perform(self, context: LaunchContext) -> str:
        name = text_of(context, self._name)
        if name in context.environment:
            return context.environment[name]
        if self._default is None:
            raise SubstitutionFailure(f"environment variable '{name}' does not exist")
        return text_of(context, self._default)


class PythonExpression(Substitution):
    def __init__(self, expression: Any, python_modules: Any = ("math",)) -> None:
        self._expression = normalize_to_list_of_substitutions(expression)
        self._modules = list(python_modules)

    def perform(self, context: LaunchContext) -> str:
        import importlib

        modules = [importlib.import_module(text_of(context, each)) for each in self._modules]
        names = {module.__name__: module for module in modules}
        names |= vars(importlib.import_module("math"))
        return str(eval(text_of(context, self._expression), {}, names))


class ThisLaunchFile(Substitution):
    def perform(self, context: LaunchContext) -> str:
        return str(context.locals_["current_launch_file_path"])


class ThisLaunchFileDir(Substitution):
    def perform(self, context: LaunchContext) -> str:
        return os.path.dirname(context.locals_["current_launch_file_path"])


class AnonName(Substitution):
    def __init__(self, name: Any) -> None:
        self._name = name

    def perform(self, context: LaunchContext) -> str:
        return f"{text_of(context, self._name)}_anonymous"


class LaunchLogDir(Substitution):
    def perform(self, context: LaunchContext) -> str:
        return "/tmp/log"


class LocalSubstitution(Substitution):
    def __init__(self, expression: str, description: str | None = None) -> None:
        self._expression = expression

    def perform(self, context: LaunchContext) -> str:
        return str(eval(f"context.locals.{self._expression}", {"context": context}))


def _is_equal(context: LaunchContext, left: Any, right: Any) -> bool:
    one, other = (text_of(context, _plain(each)) for each in (left, right))
    try:
        return float(one) == float(other)
    except ValueError:
        pass
    if {one.lower(), other.lower()} <= {"true", "false"}:
        return one.lower() == other.lower()
    return one == other


def _plain(value: Any) -> Any:
    return str(value) if isinstance(value, bool | int | float) or value is None else value


class EqualsSubstitution(Substitution):
    def __init__(self, left: Any, right: Any) -> None:
        self._both = left, right

    def perform(self, context: LaunchContext) -> str:
        return str(_is_equal(context, *self._both)).lower()


class NotEqualsSubstitution(EqualsSubstitution):
    def perform(self, context: LaunchContext) -> str:
        return str(not _is_equal(context, *self._both)).lower()


class IfElseSubstitution(Substitution):
    def __init__(self, condition: Any, if_value: Any = "", else_value: Any = "") -> None:
        self._condition, self._values = condition, (if_value, else_value)

    def perform(self, context: LaunchContext) -> str:
        is_so = evaluate_condition_expression(context, self._condition)
        return text_of(context, self._values[0 if is_so else 1])


class NotSubstitution(Substitution):
    def __init__(self, value: Any) -> None:
        self._value = value

    def perform(self, context: LaunchContext) -> str:
        return str(not evaluate_condition_expression(context, self._value)).lower()


class AndSubstitution(Substitution):
    def __init__(self, left: Any, right: Any) -> None:
        self._parts = (left, right)

    def perform(self, context: LaunchContext) -> str:
        found = [evaluate_condition_expression(context, each) for each in self._parts]
        return str(all(found)).lower()


class OrSubstitution(AndSubstitution):
    def perform(self, context: LaunchContext) -> str:
        found = [evaluate_condition_expression(context, each) for each in self._parts]
        return str(any(found)).lower()


class AllSubstitution(AndSubstitution):
    def __init__(self, *args: Any) -> None:
        self._parts = args


class AnySubstitution(OrSubstitution):
    def __init__(self, *args: Any) -> None:
        self._parts = args


__all__ = exported(__name__, "TextSubstitution")
__getattr__ = unknown("launch.substitutions")
