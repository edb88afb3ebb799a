"""The bytes of a message in one form: rclpy's own have leftovers of memory between and behind.

Plain little-endian CDR, as DDS carries it. Whatever reads a recording reads these.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable
from typing import Any

_MARK = b"\x00\x01\x00\x00"


class _Bytes:
    """CDR, field by field; each number stands at a multiple of its size."""

    def __init__(self) -> None:
        self._data = bytearray()

    def number(self, form: str, value: float) -> None:
        size = struct.calcsize(form)
        self._data += b"\x00" * (-len(self._data) % size) + struct.pack(f"<{form}", value)

    def text(self, value: str) -> None:
        encoded = value.encode("utf-8", "replace") + b"\x00"
        self.number("I", len(encoded))
        self._data += encoded

    def numbers(self, values: Iterable[float]) -> None:
        listed = list(values)
        self.number("I", len(listed))
        for value in listed:
            self.number("d", value)

    def header(self, header: Any) -> None:
        self.number("i", header.stamp.sec)
        self.number("I", header.stamp.nanosec)
        self.text(header.frame_id)

    def message(self) -> bytes:
        return _MARK + bytes(self._data)


def string(message: Any) -> bytes:
    """A std_msgs/String."""
    made = _Bytes()
    made.text(message.data)
    return made.message()


def joint_state(message: Any) -> bytes:
    """A sensor_msgs/JointState."""
    made = _Bytes()
    made.header(message.header)
    made.number("I", len(message.name))
    for name in message.name:
        made.text(name)
    for values in (message.position, message.velocity, message.effort):
        made.numbers(values)
    return made.message()


def tf_message(message: Any) -> bytes:
    """A tf2_msgs/TFMessage."""
    made = _Bytes()
    made.number("I", len(message.transforms))
    for each in message.transforms:
        made.header(each.header)
        made.text(each.child_frame_id)
        moved, turned = each.transform.translation, each.transform.rotation
        for value in (moved.x, moved.y, moved.z, turned.x, turned.y, turned.z, turned.w):
            made.number("d", value)
    return made.message()
