"""A double of ROS's `launch_ros.substitutions`."""

from __future__ import annotations

import os
from typing import Any

from ament_index_python.packages import get_package_prefix, get_package_share_directory
from launch._core import (
    LaunchContext,
    Substitution,
    exported,
    normalize_to_list_of_substitutions,
    text_of,
    unknown,
)
from launch.substitutions import SubstitutionFailure


class FindPackagePrefix(Substitution):
    def __init__(self, package: Any) -> None:
        self._package = normalize_to_list_of_substitutions(package)

    @property
    def package(self) -> list[Substitution]:
        return self._package

    def find(self, name: str) -> str:
        return get_package_prefix(name)

    def perform(self, context: LaunchContext) -> str:
        return self.find(text_of(context, self._package))


FindPackage = FindPackagePrefix


class FindPackageShare(FindPackagePrefix):
    def find(self, name: str) -> str:
        return get_package_share_directory(name)


class ExecutableInPackage(Substitution):
    def __init__(self, executable: Any, package: Any) -> None:
        self._both = package, executable

    def perform(self, context: LaunchContext) -> str:
        package, executable = (text_of(context, each) for each in self._both)
        context.record.executable(package, executable)
        return os.path.join(get_package_prefix(package), "lib", package, executable)


class Parameter(Substitution):
    """Of those that all nodes get."""

    def __init__(self, name: Any, *, default: Any = None) -> None:
        self._name, self._default = normalize_to_list_of_substitutions(name), default

    def perform(self, context: LaunchContext) -> str:
        name = text_of(context, self._name)
        for each in context.launch_configurations.get("global_params", ()):
            if isinstance(each, tuple) and each[0] == name:
                return str(each[1])
        if self._default is None:
            raise SubstitutionFailure(f"parameter '{name}' not found")
        return text_of(context, self._default)


__all__ = exported(__name__)
__getattr__ = unknown("launch_ros.substitutions")
