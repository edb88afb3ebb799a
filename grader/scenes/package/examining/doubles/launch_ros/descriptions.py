"""A double of ROS's `launch_ros.descriptions`."""

from __future__ import annotations

from typing import Any

from launch._core import unknown
from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue


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


__all__ = [
    "ComposableNode",
    "Parameter",
    "ParameterFile",
    "ParameterValue",
]
__getattr__ = unknown("launch_ros.descriptions")
