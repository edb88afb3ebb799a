"""Serialises messages as plain little-endian CDR, as DDS carries it, and parses them.

Each number stands at a multiple of its size, counted from behind the mark (OMG DDSI-RTPS 2.5, 10.2
and DDS-XTypes 1.3, 7.4.1). rclpy's own bytes have leftovers of memory between fields and behind
them: what is written here is the same each time.

`serialise` and `deserialise` go by a class's SLOT_TYPES, as Jazzy's rosidl_typesupport_fastrtps_c
does: a wstring is its UTF-16 units in four bytes each, an empty message is one byte. Nothing of ROS
is imported but the classes of fields.
"""

from __future__ import annotations

import array
import importlib
import re
import struct
from typing import Any, Final, NamedTuple

import numpy as np
import numpy.typing as npt

MARK: Final = b"\x00\x01\x00\x00"
_UNIT: Final = np.dtype("<u4")


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

    def stamp_ns(self) -> int:
        """Read a builtin_interfaces/Time [ns]."""
        return int(self.number("i")) * 1_000_000_000 + int(self.number("I"))

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


# Classes, and the types in their SLOT_TYPES ----------------------------------------------------


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


def value_type(slot: Any) -> Any:
    """Return the type of a field's values: of an array, of its elements."""
    return getattr(slot, "value_type", slot)


def number_of(slot: Any) -> Number | None:
    """Return how an array or a sequence of numbers is stored; None for anything else."""
    return NUMBERS.get(getattr(getattr(slot, "value_type", None), "typename", ""))


def members(kind: Any) -> list[tuple[str, Any]]:
    """Return the names and types of a class's fields."""
    return list(zip(kind.get_fields_and_field_types(), kind.SLOT_TYPES, strict=True))


def module_of(slot: Any) -> str:
    """Return the module in which the generators put a class: 'std_msgs.msg._string'."""
    name = re.sub("(.)([A-Z][a-z]+)", r"\1_\2", slot.name.partition("_")[0])
    name = re.sub("([a-z0-9])([A-Z])", r"\1_\2", name).lower()
    return f"{'.'.join(slot.namespaces)}._{name}"


#: Namespaces and name of a message -> its class.
_INSTALLED: Final[dict[tuple[str, ...], Any]] = {}


def installed(slot: Any) -> Any:
    """Return the installed class of a message."""
    key = (*slot.namespaces, slot.name)
    if key not in _INSTALLED:
        _INSTALLED[key] = getattr(importlib.import_module(module_of(slot)), slot.name)
    return _INSTALLED[key]


def is_made(kind: Any) -> bool:
    """Whether a class was made by `classes`, and not compiled."""
    return hasattr(type(kind), "_find")


def member_class(owner: Any, slot: Any) -> Any:
    """Return the class of a field of a class, made or installed."""
    return getattr(type(owner), "_find", installed)(slot)


# Messages --------------------------------------------------------------------------------------


def serialise(message: Any) -> bytes:
    """Return the bytes of a message."""
    out = CdrWriter()
    try:
        _write_message(out, type(message), message)
    except (struct.error, TypeError, AttributeError, LookupError, OverflowError) as error:
        raise ValueError(f"{type(message).__name__} cannot be serialised: {error}") from error
    return out.message()


def deserialise(data: bytes, kind: Any) -> Any:
    """Return the message of a class that bytes are; more bytes behind it do not matter."""
    try:
        return _read_message(CdrReader(data), kind)
    except AssertionError as error:
        raise ValueError(f"expected {kind.__name__}: {error}") from None


def _bounded(slot: Any, count: int) -> None:
    if count > getattr(slot, "maximum_size", count):
        raise ValueError(f"expected at most {slot.maximum_size} values, found {count}")


def _write_message(out: CdrWriter, kind: Any, message: Any) -> None:
    if type(message) is not kind:
        raise TypeError(f"expected {kind.__name__}, found {type(message).__name__}")
    for name, slot in members(kind):
        _write(out, kind, slot, getattr(message, name))
    if not kind.SLOT_TYPES:
        out.number("B", 0)


def _write(out: CdrWriter, kind: Any, slot: Any, value: Any) -> None:
    if hasattr(slot, "value_type"):
        if not hasattr(slot, "size"):
            _bounded(slot, len(value))
            out.number("I", len(value))
        elif len(value) != slot.size:
            raise ValueError(f"expected {slot.size} values, found {len(value)}")
        number = number_of(slot)
        if number is not None:
            out.array(value, number.dtype)
        else:
            for each in value:
                _write(out, kind, slot.value_type, each)
    elif hasattr(slot, "namespaces"):
        _write_message(out, member_class(kind, slot), value)
    elif hasattr(slot, "typename"):
        if slot.typename in NUMBERS:
            out.number(NUMBERS[slot.typename].code, value)
        else:
            out.number("B", value[0] if slot.typename == "octet" else bool(value))
    else:
        _bounded(slot, len(value))
        if "WString" in type(slot).__name__:
            units = np.frombuffer(str(value).encode("utf-16-le"), "<u2")
            out.number("I", len(units))
            out.array(units, _UNIT)
        else:
            out.text(str(value).partition("\0")[0], "strict")  # where a string of C ends


def _read_message(read: CdrReader, kind: Any) -> Any:
    message = kind(**{name: _read(read, kind, slot) for name, slot in members(kind)})
    if not kind.SLOT_TYPES:
        read.number("B")
    return message


def _read(read: CdrReader, kind: Any, slot: Any) -> Any:
    if hasattr(slot, "value_type"):
        number, size = number_of(slot), getattr(slot, "size", None)
        count = read.count() if size is None else size
        _bounded(slot, count)
        if number is None:
            return [_read(read, kind, slot.value_type) for _ in range(count)]
        numbers = read.array(count, number.dtype).astype(number.dtype)
        return array.array(number.code, numbers.tobytes()) if size is None else numbers
    if hasattr(slot, "namespaces"):
        return _read_message(read, member_class(kind, slot))
    if hasattr(slot, "typename"):
        if slot.typename in NUMBERS:
            return read.number(NUMBERS[slot.typename].code)
        byte: int = read.number("B")
        return bytes([byte]) if slot.typename == "octet" else byte != 0
    if "WString" in type(slot).__name__:
        units = read.array(read.count(), _UNIT)
        if (units > 0xFFFF).any():
            raise ValueError("expected UTF-16 in a wstring")
        text = units.astype("<u2").tobytes().decode("utf-16")
    else:
        text = read.text("replace").partition("\0")[0]
    _bounded(slot, len(text))
    return text
