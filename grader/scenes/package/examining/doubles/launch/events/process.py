"""A double of ROS's `launch.events.process`: launch files name these, and none ever happens."""

from __future__ import annotations

from typing import Any

from launch._core import unknown


class _OfProcess:
    def __init__(self, **kwargs: Any) -> None:
        pass


class ProcessExited(_OfProcess):
    pass


class ProcessStarted(_OfProcess):
    pass


class ProcessIO(_OfProcess):
    pass


class ShutdownProcess(_OfProcess):
    pass


class SignalProcess(_OfProcess):
    pass


__getattr__ = unknown("launch.events.process")
