"""What a program logs, as messages on /rosout: what rclpy's C++ publishes, nobody hears here."""

from __future__ import annotations

from typing import Any

from rcl_interfaces.msg import Log
from rclpy.impl.implementation_singleton import rclpy_implementation as _rclpy

from grader.run.clock.link import SimulatorLink
from grader.run.lockstep.endpoints import serialized
from grader.run.lockstep.faults import guarded
from grader.run.lockstep.graph import log_writer


def install(link: SimulatorLink) -> None:
    """Have loggers publish, besides what they do."""
    writer = log_writer("/")
    writer.is_hidden = True  # the graph shows that of each node
    link.add(writer)
    log = _rclpy.rclpy_logging_rcutils_log
    level_of = type(Log().level)

    def logged(severity: Any, name: str, text: str, function: str, file: str, line: int) -> None:
        log(severity, name, text, function, file, line)
        publish(int(severity), name, text, function, line)

    @guarded
    def publish(severity: int, name: str, text: str, function: str, line: int) -> None:
        level = bytes([severity]) if level_of is bytes else severity
        # without the file: it is a copy's
        message = Log(level=level, name=name, msg=text, function=function, line=line)
        message.stamp.sec, message.stamp.nanosec = divmod(link.now_ns(), 1_000_000_000)
        link.connect()
        link.publish(writer, serialized(message))

    _rclpy.rclpy_logging_rcutils_log = logged
