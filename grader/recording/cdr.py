"""Serialises messages as plain little-endian CDR, as DDS carries it, and parses them.

Each number stands at a multiple of its size, counted from behind the mark (OMG DDSI-RTPS 2.5, 10.2
and DDS-XTypes 1.3, 7.4.1). rclpy's own bytes have leftovers of memory between fields and behind
them: what is written here is the same each time.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable
from typing import Any, Final

MARK: Final = b"\x00\x01\x00\x00"


class CdrWriter:
    """Writes a message, field by field."""

    def __init__(self) -> None:
        self._data = bytearray()

    def number(self, form: str, value: float) -> None:
        """Write a number, in the format of module struct."""
        size = struct.calcsize(form)
        self._data += b"\x00" * (-len(self._data) % size) + struct.pack(f"<{form}", value)

    def text(self, value: str) -> None:
        """Write a string; what UTF-8 cannot hold, as half a surrogate pair, becomes '?'."""
        encoded = value.encode("utf-8", "replace") + b"\x00"
        self.number("I", len(encoded))
        self._data += encoded

    def numbers(self, values: Iterable[float]) -> None:
        """Write a sequence of float64."""
        listed = list(values)
        self.number("I", len(listed))
        for value in listed:
            self.number("d", value)

    def octets(self, value: bytes) -> None:
        """Write a sequence of uint8."""
        self.number("I", len(value))
        self._data += value

    def header(self, header: Any) -> None:
        """Write a std_msgs/Header."""
        self.number("i", header.stamp.sec)
        self.number("I", header.stamp.nanosec)
        self.text(header.frame_id)

    def message(self) -> bytes:
        """Return the whole message, with its mark."""
        return MARK + bytes(self._data)


class CdrReader:
    """Reads a message, field by field.

    Raises:
        ValueError: it has another mark; its methods raise it where a field is missing or damaged.
    """

    def __init__(self, data: bytes) -> None:
        if data[: len(MARK)] != MARK:
            raise ValueError("a message is no plain little-endian CDR")
        self._data = data[len(MARK) :]
        self._at = 0

    def number(self, form: str) -> Any:
        """Read a number, in the format of module struct."""
        size = struct.calcsize(form)
        self._at += -self._at % size
        return struct.unpack(f"<{form}", self._read(size))[0]

    def text(self) -> str:
        """Read a string."""
        encoded = self._read(self.number("I"))
        if encoded[-1:] != b"\x00":
            raise ValueError("a string has no end")
        return encoded[:-1].decode("utf-8")

    def numbers(self) -> tuple[float, ...]:
        """Read a sequence of float64."""
        return self.array(self.number("I"))

    def array(self, count: int) -> tuple[float, ...]:
        """Read so many float64."""
        self._at += -self._at % 8 if count else 0
        return struct.unpack(f"<{count}d", self._read(8 * count))

    def texts(self) -> tuple[str, ...]:
        """Read a sequence of strings."""
        return tuple(self.text() for _ in range(self.number("I")))

    def octets(self) -> bytes:
        """Read a sequence of uint8."""
        return self._read(self.number("I"))

    def stamp_ns(self) -> int:
        """Read a builtin_interfaces/Time [ns]."""
        return int(self.number("i")) * 1_000_000_000 + int(self.number("I"))

    def end(self) -> None:
        """Check that the message ends here, but for padding to a multiple of four bytes."""
        if len(self._data) - self._at > 3:
            raise ValueError(f"{len(self._data) - self._at} bytes follow a message")

    def _read(self, size: int) -> bytes:
        found = self._data[self._at : self._at + size]
        if len(found) < size:
            raise ValueError(f"a message of {len(self._data)} bytes is cut off")
        self._at += size
        return found


def string(text: str) -> bytes:
    """Serialise a std_msgs/String."""
    made = CdrWriter()
    made.text(text)
    return made.message()


def string_of(data: bytes) -> str:
    """Parse a std_msgs/String.

    Raises:
        ValueError: the bytes are none.
    """
    read = CdrReader(data)
    text = read.text()
    read.end()
    return text
