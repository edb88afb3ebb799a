"""A double of ROS's `launch.descriptions`."""

from __future__ import annotations

from typing import Any

from launch._core import unknown


class Executable:
    def __init__(
        self,
        *,
        cmd: Any,
        prefix: Any = None,
        name: Any = None,
        cwd: Any = None,
        env: Any = None,
        additional_env: Any = None,
        arguments: Any = None,
    ) -> None:
        self.cmd = [*cmd, *(arguments or [])]


__getattr__ = unknown("launch.descriptions")
