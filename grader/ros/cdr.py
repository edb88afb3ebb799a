"""Serialises messages as plain little-endian CDR, as DDS carries it, and parses them.

Each number stands at a multiple of its size, counted from behind the mark (OMG DDSI-RTPS 2.5, 10.2
and DDS-XTypes 1.3, 7.4.1). rclpy's own bytes have leftovers of memory between fields and behind
them: what is written here is the same each time.
"""

from __future__ import annotations

import struct
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

MARK: Final = b"\x00\x01\x00\x00"


class Number(NamedTuple):
    """How numbers are stored: their code in arrays and structs, numpy's type."""

    code: str
    dtype: np.dtype[Any]


#: Basic type -> how arrays of it are stored; those of others are lists.
NUMBERS: Final = {
    name: Number(code, np.dtype(dtype))
    for name, code, dtype in (
        *(("int8", "b", "i1"), ("uint8", "B", "u1"), ("int16", "h", "i2"), ("uint16", "H", "u2")),
        *(("int32", "i", "i4"), ("uint32", "I", "u4"), ("int64", "q", "i8"), ("uint64", "Q", "u8")),
        *(("float", "f", "f4"), ("double", "d", "f8")),
    )
}


class CdrWriter:
    """Writes a message, field by field."""

    def __init__(self) -> None:
        self._data = bytearray()

    def number(self, form: str, value: float) -> None:
        """Write a number, in the format of module struct."""
        size = struct.calcsize(form)
        self._data += b"\x00" * (-len(self._data) % size) + struct.pack(f"<{form}", value)

    def text(self, value: str, errors: str = "replace") -> None:
        """Write a string; what UTF-8 cannot hold, as half a surrogate pair, becomes '?'."""
        self.octets(value.encode("utf-8", errors) + b"\x00")

    def array(self, values: Any, dtype: np.dtype[Any]) -> None:
        """Write numbers without how many they are."""
        if len(values):
            self._data += b"\x00" * (-len(self._data) % dtype.itemsize)
            self._data += np.asarray(values, dtype.newbyteorder("<")).tobytes()

    def octets(self, value: bytes) -> None:
        self.number("I", len(value))
        self._data += value

    def message(self) -> bytes:
        """Return the whole message, with its mark."""
        return MARK + bytes(self._data)


class CdrReader:
    """Reads a message, field by field.

    Raises:
        ValueError: it has another mark; its methods raise it where a field is missing or damaged.
    """

    def __init__(self, data: bytes) -> None:
        if data[:2] != MARK[:2] or len(data) < len(MARK):
            raise ValueError("a message is no plain little-endian CDR")
        self._data = data[len(MARK) :]
        self._at = 0

    def number(self, form: str) -> Any:
        """Read a number, in the format of module struct."""
        size = struct.calcsize(form)
        self._at += -self._at % size
        return struct.unpack(f"<{form}", self._read(size))[0]

    def count(self) -> int:
        """Read how many follow, each in a byte or more."""
        count: int = self.number("I")
        self._need(count)
        return count

    def text(self, errors: str = "strict") -> str:
        """Read a string; with "replace" anything is one."""
        encoded = self.octets()
        if encoded[-1:] != b"\x00" and errors == "strict":
            raise ValueError("a string has no end")
        return encoded.removesuffix(b"\x00").decode("utf-8", errors)

    def array(self, count: int, dtype: np.dtype[Any]) -> npt.NDArray[Any]:
        self._at += -self._at % dtype.itemsize if count else 0
        return np.frombuffer(self._read(dtype.itemsize * count), dtype.newbyteorder("<"))

    def octets(self) -> bytes:
        return self._read(self.number("I"))

    def end(self) -> None:
        """Check that the message ends here, but for padding to a multiple of four bytes."""
        if len(self._data) - self._at > 3:
            raise ValueError(f"{len(self._data) - self._at} bytes follow a message")

    def _need(self, size: int) -> None:
        if size > len(self._data) - self._at:
            raise ValueError(f"a message of {len(self._data)} bytes is cut off")

    def _read(self, size: int) -> bytes:
        self._need(size)
        self._at += size
        return self._data[self._at - size : self._at]


def string(text: str) -> bytes:
    made = CdrWriter()
    made.text(text)
    return made.message()


def string_of(data: bytes) -> str:
    """Parse a std_msgs/String."""
    read = CdrReader(data)
    text = read.text()
    read.end()
    return text
